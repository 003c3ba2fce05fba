"""Contacts are no farther apart than the contact spacing, and half as far along rims and below first layers.

The judge is plane geometry: the finished supports are cut just below the part, and the contacts in that section, grown
by a distance, must cover the underside of the part or hang together.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, JoinType, Manifold
from scipy.spatial import KDTree
from tests.shared.examples import examples
from tests.shared.layouts import box, layout, placed, route
from tests.shared.optional import present
from tests.shared.solids import mesh_of

import amprep
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model import Part
from amprep.model.supports import OUT_OF_TIME, SupportEdges, SupportPlan, Unconnected
from amprep.supports.grid.red_squares import RedSquares
from amprep.supports.grid.spacing import are_beside, steps_within

SPACING, HEIGHT = 2.0, 4.0


def slab(*plan):
    """A slab in the air over rectangles (x, y, width, depth), and its underside; a negative width is a hole."""
    face = CrossSection()
    for x, y, width, depth in plan:
        area = CrossSection.square([abs(width), depth]).translate([30.0 + x, 30.0 + y])
        face = face - area if width < 0 else face + area
    solid = face.extrude(2.0).translate([0.0, 0.0, HEIGHT])
    return Part("slab", mesh_of(solid), solid.volume()), face


def supported(part, **settings):
    """The layout, and the contacts of the finished supports as a plane figure."""
    usual = {
        "supports.rules": "thesis",
        "cells.strategy": "prism",
        "supports.contact_spacing_mm": SPACING,
        "supports.min_area_mm2": 0.0,
    }
    planned = amprep.plan_supports(amprep.load(part, settings={**usual, **settings}))
    found = amprep.emit_cells(planned)
    assert found.build.unsupported == ()
    (body,) = found.build.supports
    return present(planned.layout), as_manifold(*body.mesh.arrays).slice(HEIGHT - 0.005)


def grown(contacts, distance):
    return contacts.offset(distance, JoinType.Round, 2.0, 48)


def area_beyond(face, contacts, distance):
    """Area of a figure that is farther from all contacts than a distance."""
    return (face - grown(contacts, distance + 0.02)).area()


def hang_together(contacts, gap):
    """Whether no gap between neighbouring contacts is wider."""
    return len(grown(contacts, gap / 2 + 0.02).decompose()) == 1


@given(
    pitch=st.sampled_from([0.5, 0.65, 0.8, 1.0]),
    arm=st.floats(2, 9),
    x=st.floats(1, 6),
    y=st.floats(1, 5),
    hole=st.floats(0.5, 4),
)
@examples(6)
def test_contacts_are_at_most_the_spacing_apart_and_half_of_it_along_rims(pitch, arm, x, y, hole):
    part, face = slab((0, 0, 12, 8), (12, 2, arm, 3), (x, y, -hole, 2))
    _, contacts = supported(part, **{"supports.pitch_mm": pitch})
    assert hang_together(contacts, SPACING - pitch)
    assert area_beyond(face, contacts, (SPACING - pitch) / np.sqrt(2)) < 1e-3
    rim = face - face.offset(-0.05, JoinType.Miter)
    assert area_beyond(rim, contacts, SPACING / 2) < 1e-3


def test_fewer_contacts_take_less_material_and_no_spacing_takes_all_red_squares():
    part, _ = slab((0, 0, 20, 20))
    (every, whole), (some, spaced) = (
        supported(part, **{"supports.pitch_mm": 0.8, "supports.contact_spacing_mm": spacing})
        for spacing in (0.0, SPACING)
    )
    assert every.connected.all()
    assert some.connected.all()
    assert len(some.red.part) < 0.45 * len(every.red.part)
    assert spaced.area() < 0.45 * whole.area()
    assert not every.close.any()


def test_the_first_layers_of_a_large_region_in_the_air_have_contacts_half_as_far_apart():
    limits = {"supports.rules": "limits", "supports.pitch_mm": 0.5, "material": "metal"}
    large, face = slab((0, 0, 12, 10))
    _, contacts = supported(large, **limits)
    assert hang_together(contacts, SPACING / 2 - 0.5)
    assert area_beyond(face, contacts, (SPACING / 2 - 0.5) / np.sqrt(2)) < 1e-3
    small, _ = slab((0, 0, 10, 9.5))
    assert not hang_together(supported(small, **limits)[1], SPACING / 2 - 0.5)


@pytest.mark.parametrize(("connector", "pitch"), [("teeth", 3.0), ("point", 3.0), ("teeth", 1.2)])
def test_teeth_and_points_are_as_far_apart_as_the_spacing_at_any_pitch_of_the_grid(connector, pitch):
    part, face = slab((0, 0, 18, 15))
    planned, contacts = supported(part, **{"supports.pitch_mm": pitch, "cells.connector": connector})
    tips: np.ndarray = np.array([each.to_polygons()[0].mean(axis=0) for each in contacts.decompose()])
    apart = np.asarray(KDTree(tips).query(tips, 5)[0])
    assert apart[:, 1].max() <= SPACING
    assert area_beyond(face, contacts, SPACING / np.sqrt(2)) < 1e-3
    rim = face - face.offset(-0.05, JoinType.Miter)
    assert area_beyond(rim, contacts, SPACING / 2) < 1e-3
    inner = np.abs(tips - np.array(face.bounds()).reshape(2, 2).mean(axis=0)).max(axis=1) < 3.5
    assert 0.6 * SPACING - 0.3 < np.median(apart[inner, 1]) <= SPACING, "no denser than asked for"
    assert planned.close.any()
    assert not planned.close.all()


def test_a_stated_pitch_of_teeth_holds():
    part, _ = slab((0, 0, 12, 12))
    settings = {"supports.pitch_mm": 3.0, "cells.connector": "teeth", "cells.tooth_pitch_mm": 0.75}
    _, contacts = supported(part, **settings)
    assert len(contacts.decompose()) == pytest.approx((12 / 0.75) ** 2, rel=0.1)


def test_lowest_points_are_supported():
    solid = Manifold.sphere(8.0, 48).translate([40.0, 40.0, 8.0 + HEIGHT])
    part = Part("ball", mesh_of(solid), solid.volume())
    planned = amprep.plan_supports(
        amprep.load(part, settings={"supports.rules": "thesis", "supports.pitch_mm": 0.55})
    )
    found = present(planned.layout)
    assert planned.build.resolved.job.supports.contact_spacing_mm == SPACING
    middle = found.grid.origin[:2] + (found.red.square[:, :0:-1] + 0.5) * found.grid.pitch
    assert np.abs(middle - 40.0).max(axis=1).min() <= found.grid.pitch


def test_squares_beside_one_that_cannot_be_connected_are_connected_instead():
    refused: list[np.ndarray] = []

    def refuse_one(problem, stop, progress):
        """Route all red squares but one in the middle of the first problem, whichever problem it is in."""
        places = problem.grid.origin + problem.red[:, ::-1] * problem.grid.size
        refused.append(refused[0] if refused else places[len(places) // 2])
        out = (np.abs(places - refused[0]) < 1e-6).all(axis=1)
        left = {name: getattr(problem, name)[~out] for name in ("red", "red_part", "red_region")}
        kept = np.flatnonzero(~out)
        if not len(kept):
            return SupportPlan(
                SupportEdges.from_rows([]), (Unconnected(0, OUT_OF_TIME),), stop_reason=OUT_OF_TIME
            )
        plan = route(replace(problem, **left), stop, progress)
        listed = [*(replace(each, red=int(kept[each.red])) for each in plan.unconnected)]
        listed += [Unconnected(int(number), OUT_OF_TIME) for number in np.flatnonzero(out)]
        return replace(plan, unconnected=tuple(listed), stop_reason=OUT_OF_TIME)

    parts = placed(box([12, 12, 2], [20, 20, 5]))
    settings = {"pitch_mm": 0.5, "contact_spacing_mm": SPACING}
    plain, found = layout(parts, **settings), layout(parts, route=refuse_one, **settings)
    (lost,) = np.flatnonzero(~found.connected)
    every = layout(parts, pitch_mm=0.5).red.square
    beside, all_beside = (
        np.abs(squares - found.red.square[lost]).max(axis=1) * 0.5 <= SPACING
        for squares in (found.red.square, every)
    )
    assert beside.sum() == all_beside.sum(), "all squares within the spacing of the one that is lost"
    assert len(plain.red.part) < len(found.red.part) < len(every)
    assert plain.connected.all()


@given(distance=st.floats(0.1, 10), pitch=st.floats(0.1, 4))
def test_the_steps_within_a_distance_are_as_many_as_fit(distance, pitch):
    steps = steps_within(distance, pitch)
    assert steps == 1 or steps * pitch <= distance + 1e-6
    assert (steps + 1) * pitch > distance - 1e-6


@examples(20)
@given(st.integers(0, 100_000), st.integers(1, 4))
def test_squares_beside_others_are_those_that_all_distances_find(seed, steps):
    rng = np.random.default_rng(seed)
    square, part = rng.integers(0, 12, (60, 3)), np.sort(rng.integers(0, 3, 60))
    nothing = np.zeros(60, np.int64)
    red = RedSquares(**dict.fromkeys(RedSquares._fields, nothing) | {"square": square, "part": part})
    numbers = rng.choice(60, rng.integers(0, 8), replace=False)
    distance = np.abs(square[:, None] - square[numbers]).max(axis=2)
    expected = ((distance <= steps) & (part[:, None] == part[numbers])).any(axis=1)
    assert are_beside(red, numbers, steps).tolist() == expected.tolist()
