"""Verdicts on made shapes: kind and size of every overhang, and whether the part carries it, by limits of profiles."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared import bore_shapes
from tests.shared.examples import examples
from tests.shared.overhang_shapes import PLATE, bore, box, bridge, ledge
from tests.shared.overhang_table import SHAPES
from tests.shared.solids import arrays

from amprep.geometry.overhangs.carried.points import Limits
from amprep.geometry.overhangs.limited import find_limited_overhangs
from amprep.materials.catalogue import find_material

LAYER = 0.04
PROFILES = ("metal", "metal-tolerant", "metal-cautious")
BY_NAME = {shape.name: shape for shape in SHAPES + bore_shapes.SHAPES}


def limits_of(name):
    profile = find_material(name)
    return Limits(45.0, profile.ledge_mm, profile.bridge_mm, profile.bore_mm, PLATE, LAYER)


def found_on(mesh, limits):
    vertices, triangles = mesh
    return find_limited_overhangs(vertices, triangles, limits)


def regions_of(mesh, limits):
    return found_on(mesh, limits).overhangs.regions


def limit_of(kind, limits):
    return {"ledge": limits.ledge, "bridge": limits.bridge, "bore": limits.bore, "flat": -1.0}[kind]


def is_carried(expected, limits):
    """Whether the part carries an overhang of a shape, by its kind and size alone."""
    if expected.starts:
        return False
    if expected.kind == "edge":
        return expected.size <= (limits.ledge if expected.at_one_end else max(limits.bridge, limits.ledge))
    return expected.size <= limit_of(expected.kind, limits)


def require_verdicts(mesh, shape, limits):
    found = sorted(regions_of(mesh, limits), key=lambda each: (each.kind, each.size_mm))
    wanted = sorted(shape.overhangs)
    if not any(each.kind == "edge" for each in wanted):
        assert all(each.is_self_supporting for each in found if each.kind == "edge")
        found = [each for each in found if each.kind != "edge"]
    assert [each.kind for each in found] == [each.kind for each in wanted]
    for region, expected in zip(found, wanted, strict=True):
        assert region.size_mm == pytest.approx(expected.size, abs=0.1)
        assert region.starts_in_air == expected.starts
        assert region.is_self_supporting == is_carried(expected, limits)


def closest_profiles(shape):
    """The two profiles whose limits are closest to a size of the shape, where verdicts go wrong most easily."""

    def distance(name):
        limits = limits_of(name)
        sizes = [each for each in shape.overhangs if each.kind not in ("edge", "flat")]
        return min((abs(limit_of(each.kind, limits) - each.size) for each in sizes), default=0.0)

    return sorted(PROFILES, key=distance)[:2]


@pytest.mark.parametrize("shape", SHAPES + bore_shapes.SHAPES, ids=lambda shape: shape.name)
def test_a_made_shape_has_the_verdicts_that_follow_from_its_dimensions(shape):
    mesh = arrays(shape.make())
    for profile in closest_profiles(shape):
        require_verdicts(mesh, shape, limits_of(profile))


TURNED = (
    "ledge of 2.0",
    "bridge of 3.9",
    "bore of 9.9",
    "counterbore",
    "corner shelf",
    "T-slot beside",
    "cove",
    "dome",
    "bore tilted by 10",
    "bore tilted by 25",
    "steep bore",
    "twelve sides with a corner above",
    "bridge that widens to 3.4",
    "bridge that widens to 5.0",
)


@pytest.mark.parametrize("name", TURNED)
def test_verdicts_do_not_depend_on_the_turn_about_z_nor_on_the_mesh(name):
    shape, tolerant = BY_NAME[name], limits_of("metal-tolerant")
    solid = shape.make().rotate((0, 0, 37.3))
    require_verdicts(arrays(solid.refine_to_length(1.3)), shape, tolerant)
    vertices, triangles = arrays(solid)
    soup = vertices[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3)
    require_verdicts(soup, shape, tolerant)


@given(
    st.sampled_from(PROFILES),
    st.floats(-0.3, 0.3),
    st.sampled_from(["ledge", "bridge", "bore"]),
    st.floats(0, 90),
)
@examples(12)
def test_near_its_limit_an_overhang_is_carried_just_if_it_does_not_exceed_it(profile, beyond, kind, turn):
    limits = limits_of(profile)
    size = limit_of(kind, limits) + beyond + (0.03 if beyond > 0 else 0.0)
    makers: dict[str, Any] = {"ledge": ledge, "bridge": bridge, "bore": bore}
    made = makers[kind](size)
    (region,) = [
        each for each in regions_of(arrays(made.rotate((0, 0, turn))), limits) if each.kind != "edge"
    ]
    assert (region.kind, region.is_self_supporting) == (kind, beyond <= 0)
    assert region.size_mm == pytest.approx(size, abs=0.1)


SIDE, STEP = 9, 0.04


def ceiling(posts):
    """A flat ceiling of `SIDE` times `SIDE` cells of 1 mm on posts in the cells given."""
    solid = box((SIDE, SIDE, 3), (0, 0, 10))
    for x, y in sorted(posts):
        solid += box((1, 1, 10), (x, y, 0))
    return solid


def cast(points, posts):
    """Ledges and bridges at points by brute force: steps along many directions over the cells."""
    held = np.zeros((SIDE, SIDE), bool)
    held[tuple(np.array(sorted(posts)).T)] = True
    angle = np.linspace(0, 2 * np.pi, 320, endpoint=False)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    length = np.arange(STEP, SIDE * 1.5, STEP)
    at = points[:, None, None] + length[:, None] * way[:, None]
    outside = ((at <= 0) | (at >= SIDE)).any(axis=3)
    cell = np.clip(np.floor(at).astype(int), 0, SIDE - 1)
    ends = outside | held[cell[..., 0], cell[..., 1]]
    first = ends.argmax(axis=2)
    anchored = ~np.take_along_axis(outside, first[..., None], axis=2)[..., 0]
    reach = np.where(anchored, length[first], np.inf)
    return reach.min(axis=1), (reach[:, :160] + reach[:, 160:]).min(axis=1)


def carried(points, posts, ledge_mm, bridge_mm):
    ledges, bridges = cast(points, posts)
    return (ledges <= ledge_mm) | (bridges <= bridge_mm)


def in_faces(result, points):
    """Whether points are below faces that need support, in plan."""
    corners = result.vertices[result.triangles[result.overhangs.faces]][:, :, :2]
    found = np.zeros(len(points), bool)
    for a, b, c in corners:
        inside = np.ones(len(points), bool)
        for p, q in ((a, b), (b, c), (c, a)):
            (dx, dy), (x, y) = q - p, (points - p).T
            inside &= dx * y - dy * x <= 1e-9
        found |= inside
    return found


@given(
    st.sets(st.tuples(st.integers(0, SIDE - 1), st.integers(0, SIDE - 1)), min_size=1, max_size=9),
    st.integers(0, 99),
)
@examples(5)
def test_on_ceilings_with_posts_the_same_points_are_carried_as_by_brute_force(posts, seed):
    result = found_on(arrays(ceiling(posts)), limits_of("metal-tolerant"))
    points = np.random.default_rng(seed).uniform(0.05, SIDE - 0.05, (40, 2))
    points = points[[tuple(np.floor(each).astype(int).tolist()) not in posts for each in points]]
    found = in_faces(result, points)
    assert found[~carried(points, posts, 2.0 + 2 * STEP, 4.0 + 3 * STEP)].all()
    for point in points[found & carried(points, posts, 2.0, 4.0)]:
        circle = 0.35 * np.stack([np.cos(np.arange(24)), np.sin(np.arange(24))], axis=1)
        around = np.clip(point + np.linspace(0.2, 1, 24)[:, None] * circle, 0.01, SIDE - 0.01)
        assert not carried(around, posts, 2.0 - STEP, 4.0 - STEP).all(), point
