"""Connectors of every kind end in the true surface; tips, necks and openings have the sizes of the rules."""

from functools import cache

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold

from amprep.checks.supports.bodies import check_bodies
from amprep.checks.supports.contacts import check_contacts
from amprep.checks.supports.coverage import check_coverage
from amprep.checks.supports.least_section import check_least_section
from amprep.errors import JobError
from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.connectors.least_width import LeastSection
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.supports.contact_area import contact_corners, measure_contact
from amprep.host import Host
from amprep.job.loading import make_job
from amprep.model import Build, BuildSettings, BuildVolume, Mesh, Part, PlacedPart, Stop, silent
from amprep.model.contacts import ConnectorRules
from amprep.model.supports.sizes import SupportSizes
from amprep.overhangs.unsupported import find_unsupported
from amprep.supports.plan import PlanningRules, plan_supports
from amprep.supports.solids.build import SolidRules, build_supports
from amprep.supports.solids.tips import TipSpacing, shape_connectors

SPACE = BuildVolume(np.array([60.0, 60.0, 60.0]))
PITCH, OVERLAP = 2.0, 0.1
KINDS = {
    "full": ConnectorRules(),
    "teeth": ConnectorRules("teeth"),
    "point": ConnectorRules("point", point_mm=0.5, point_height_mm=1.0),
    "points": ConnectorRules("point", point_pitch_mm=1.0, point_mm=0.4, point_height_mm=0.8, neck_mm=0.25),
    "neck": ConnectorRules("full", neck_mm=0.5),
    "necked teeth": ConnectorRules("teeth", neck_mm=0.3),
    "perforated": ConnectorRules("full", perforation_mm=0.5),
    "extend": ConnectorRules("extend"),
}


def slab(side=8.0, bottom=8.0):
    return Manifold.cube((side, side, 2.0)).translate((16.0, 16.0, bottom))


def ball():
    return Manifold.sphere(6.0, 48).translate((15.3, 14.9, 9.1))


def tilted():
    return Manifold.cube((12.0, 7.0, 2.0)).rotate((0.0, -25.0, 10.0)).translate((14.0, 11.0, 9.0))


def bracket():
    """A wall on the plate with a shelf that has a hole in it, and a rib with a sharp lower edge."""
    shelf = Manifold.cube((10.0, 8.0, 2.0)).translate((13.0, 11.0, 9.3))
    rib = CrossSection([[(0, 0), (1.5, 4), (-1.5, 4)]]).extrude(6.0).rotate((90, 0, 0))
    return (
        Manifold.cube((3.0, 8.0, 12.0)).translate((10.0, 11.0, 0.0))
        + shelf
        + rib.translate((20.0, 18.0, 6.4))
        - Manifold.cylinder(5.0, 1.6).translate((16.0, 15.0, 8.0))
    )


SHAPES = {"slab": slab, "ball": ball, "tilted": tilted, "bracket": bracket}


def flange():
    """A turned plate with a round end and a bore, whose borders cut the squares of the grid at any place."""
    plate = Manifold.cube((14.0, 9.0, 2.0)) + Manifold.cylinder(2.0, 4.5, 4.5, 40).translate((14.0, 4.5, 0.0))
    whole = plate - Manifold.cylinder(6.0, 2.1, 2.1, 40, center=True).translate((11.3, 4.4, 0.0))
    return whole.rotate((0.0, 0.0, 13.0)).translate((12.0, 9.0, 7.7))


LEAST = LeastSection(0.3, 0.09)


def placed(solid, name="part"):
    mesh = solid.to_mesh64()
    whole = Mesh(np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, np.int32))
    return PlacedPart(name, Part(name, whole, whole.signed_volume), np.eye(4))


def solid_of(mesh):
    return as_manifold(mesh.vertices, mesh.triangles)


@cache
def host():
    return Host.load(plugins_enabled=False)


@cache
def scene(shape):
    part = placed((SHAPES | {"flange": flange})[shape]())
    router = host().choose("router", "shortest-paths")

    def route(problem, stop, progress):
        rng = np.random.default_rng(0)
        return host().call(
            router, problem, params=host().params(router, {}), rng=rng, stop=stop, progress=progress
        )

    return part, plan_supports(
        (part,), SPACE, PlanningRules(pitch_mm=PITCH), route=route, stop=Stop(), progress=silent
    )


def supports(shape, connector, cell="prism", **more):
    part, layout = scene(shape)
    emitter = host().choose("cell", cell)
    params = host().params(emitter, {})
    return build_supports(
        layout,
        (part,),
        lambda request: host().call(emitter, request, params=params, stop=Stop(), progress=silent),
        SolidRules(connector=connector, overlap=OVERLAP, **more),
        stop=Stop(),
        progress=silent,
    )


@cache
def body(shape, kind):
    """Return the one support of a shape as a solid."""
    (support,) = supports(shape, KINDS[kind])
    return solid_of(support.mesh)


def judged(shape, bodies):
    part, layout = scene(shape)
    settings = BuildSettings("b", SPACE, overlap=OVERLAP, reach=1.5 * PITCH)
    unsupported = find_unsupported((part,), layout.overhangs, bodies, settings, layout.reason_at)
    build = Build(settings, (part,), bodies, unsupported)
    grid, (plane, y, x) = layout.grid, layout.red.square[layout.connected].T.astype(float)
    size = np.array([grid.pitch, grid.pitch, grid.step])
    lo = grid.origin + np.column_stack([x, y, plane]) * size
    hi = lo + np.column_stack([x * 0 + 1, x * 0 + 1, layout.red.rise[layout.connected]]) * size
    contacts = check_contacts(build, lo, hi, layout.red.part[layout.connected])
    return [*check_bodies(build, Stop()), *check_coverage(build), *contacts]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("shape", SHAPES)
def test_connectors_of_every_kind_keep_every_promise(shape, kind):
    """Closed, on the plate, nowhere deeper than the overlap, in reach of all, in contact above every red square."""
    assert judged(shape, supports(shape, KINDS[kind])) == []


@pytest.mark.parametrize(
    ("shape", "kind"), [*(("flange", kind) for kind in KINDS), ("bracket", "point"), ("tilted", "teeth")]
)
def test_no_section_of_connectors_of_any_kind_is_thinner_than_the_least(shape, kind):
    """As strictly in tips as elsewhere, if their rules make them no thinner."""
    rules, part = KINDS[kind], scene(shape)[0]
    sizes = SupportSizes(PITCH, rules.tip_width_mm, rules.tip_height_mm, rules.neck_mm)
    settings = BuildSettings("b", SPACE, sizes=sizes if rules.neck_mm else SupportSizes())
    bodies = supports(shape, rules, least=LEAST)
    assert bodies
    assert check_least_section(Build(settings, (part,), bodies), Stop())[0] == []


def test_the_judge_finds_a_red_square_without_contact():
    bodies = supports("slab", ConnectorRules())
    cut = solid_of(bodies[0].mesh) - Manifold.cube((2.0, 2.0, 3.0)).translate((18.0, 18.0, 7.0))
    (support,) = (placed(cut),)
    found = judged("slab", (bodies[0].__class__("cut", support.part.mesh, (0,)),))
    assert [each.promise for each in found] == ["connector touches its part"]


@pytest.mark.parametrize(
    ("cell", "shape"), [("x-wall", "bracket"), ("strut", "bracket"), ("bcc", "slab"), ("hatch", "slab")]
)
def test_teeth_and_points_fit_every_cell(cell, shape):
    for kind in ("necked teeth", "point") if cell != "hatch" else ("point",):
        assert judged(shape, supports(shape, KINDS[kind], cell)) == []


@pytest.mark.parametrize("on_solid", [False, True])
@pytest.mark.parametrize("covered", [0.6, 2.0])
def test_tips_begin_inside_a_cell_only_if_something_is_below_them(covered, on_solid):
    """A cell with openings may have none below a contact that covers a part of its square."""
    columns = ConnectorColumns(
        np.zeros((1, 3)),
        np.array([[2.0, 2.0, 4.0]]),
        np.zeros((1, 2), np.int64),
        np.array([0.0, 0.0, 2.0]),
        (1, 1),
    )
    a, b, c, d = ((x, y, 0.4) for x, y in ((0, 0), (covered, 0), (covered, covered), (0, covered)))
    plain = Manifold.cube((covered, covered, 1.5)).translate((0.0, 0.0, -1.0))
    shaped = shape_connectors(
        plain,
        np.array([[a, c, b], [a, d, c]], float),
        columns,
        np.array([-0.1]),
        np.array([1.0]),
        ConnectorRules("point"),
        TipSpacing(0.0, np.zeros(1, np.bool_)),
        OVERLAP,
        np.array([on_solid]),
        LEAST,
    )
    sunk = on_solid or covered == 2.0
    assert shaped.notch.is_empty() != sunk
    assert (shaped.connectors.bounding_box()[2] < -0.5) == sunk
    assert shaped.connectors.bounding_box()[5] == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("shape", SHAPES)
def test_contact_shrinks_from_full_to_teeth_to_points(shape):
    part, _ = scene(shape)
    areas, volumes = [], []
    for kind in ("full", "teeth", "point"):
        (support,) = supports(shape, KINDS[kind])
        areas.append(measure_contact((support.mesh.vertices, support.mesh.triangles),
                                     (part.mesh.vertices, part.mesh.triangles)).area)  # fmt: skip
        volumes.append(support.mesh.signed_volume)
    assert areas[0] > 1.5 * areas[1] > 1.5 * areas[2] > 0.0
    assert volumes[0] > volumes[1] > 0.0


@pytest.mark.parametrize("kind", ["teeth", "points", "neck"])
def test_contacts_follow_the_true_surface_to_the_overlap(kind):
    """On slopes without steps the volume in the part is the contact in plan times the overlap."""
    part = solid_of(scene("tilted")[0].mesh)
    common = body("tilted", kind) ^ part
    corners = contact_corners(body("tilted", kind), part)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat = -normal[normal[:, 2] < 0.0, 2].sum() / 2.0
    assert common.volume() == pytest.approx(OVERLAP * flat, rel=0.05)


def sections(solid, height):
    """Return bounds and areas of the pieces of a level cut."""
    pieces = solid.slice(height).decompose()
    return np.array([piece.bounds() for piece in pieces]), np.array([piece.area() for piece in pieces])


def flat(connector):
    """Return supports of a level slab, 8 x 8 mm on the grid, its underside at 9.9 mm."""
    SHAPES["flat"] = lambda: slab(8.0, 9.9)
    (support,) = supports("flat", connector)
    return solid_of(support.mesh)


def test_teeth_have_the_pitch_and_width_of_the_rules_and_are_on_shoulders():
    teeth = flat(ConnectorRules("teeth", 1.0, 0.4, 0.7))
    bounds, areas = sections(teeth, 9.9)
    assert len(areas) == 64
    assert areas == pytest.approx(np.full(64, 0.16), rel=1e-3)
    middles = np.unique(np.round((bounds[:, 0] + bounds[:, 2]) / 2, 3))
    assert np.diff(middles) == pytest.approx(np.ones(7), abs=1e-3)
    _, areas = sections(teeth, 9.9 - 0.71)
    assert areas == pytest.approx([64.0], rel=1e-3)
    _, halfway = sections(teeth, 9.9 - 0.35)
    assert (halfway > 0.3).all()
    assert (halfway < 0.6).all()


@pytest.mark.parametrize(
    ("connector", "count"),
    [
        (ConnectorRules("teeth", 1.0, 0.5, 0.8, neck_mm=0.25, neck_height_mm=0.2), 64),
        (ConnectorRules("full", neck_mm=0.6, neck_height_mm=0.4), 16),
        (ConnectorRules("point", point_mm=0.6, point_height_mm=1.0, neck_mm=0.3, neck_height_mm=0.3), 16),
    ],
)
def test_necks_have_the_width_and_height_of_the_rules(connector, count):
    solid = flat(connector)
    bounds, areas = sections(solid, 9.9 - connector.neck_height_mm)
    assert len(areas) == count
    wide = bounds[:, 2:] - bounds[:, :2]
    assert wide == pytest.approx(np.full((count, 2), connector.neck_mm), rel=0.04)  # a circle has 12 sides
    for other in (0.1, -0.1):
        _, around = sections(solid, 9.9 - connector.neck_height_mm + other)
        assert around.min() > 1.1 * areas.max()


def test_points_are_round_and_have_the_pitch_of_the_rules():
    for pitch, count in ((None, 16), (1.0, 64)):
        _, areas = sections(
            flat(ConnectorRules("point", point_pitch_mm=pitch, point_mm=0.5, point_height_mm=0.8)), 9.9
        )
        assert areas == pytest.approx(np.full(count, 3.0 * 0.25**2), rel=1e-3)  # of twelve sides


def test_openings_go_straight_through_and_leave_posts():
    """Two rows of diamonds fit below the slab; lines through their middles meet nothing."""
    whole, pierced = flat(ConnectorRules()), flat(ConnectorRules(perforation_mm=0.6))
    tall = 0.6 * np.tan(np.radians(55.0))
    crossing = 0.6 * tall / 2.0
    assert pierced.volume() < whole.volume() - 7.0 * crossing
    middle = 8.0 + 0.2 + tall / 2.0
    for row in range(3):
        line = Manifold.cube((0.1, 12.0, 0.1), center=True).translate((17.0 + 2 * row, 20.0, middle))
        assert (pierced ^ line).is_empty()
        assert (pierced ^ line.translate((1.0, 0.0, 0.0))).volume() > 0.05
    assert pierced.slice(9.8).area() == pytest.approx(64.0, rel=1e-3)
    assert len(pierced.decompose()) == len(whole.decompose())


def test_a_point_is_at_the_lowest_spot_of_its_square():
    """Below a ball that hangs over the middle of a square, not over its centre."""
    low = body("ball", "point") ^ Manifold.cube((4.0, 4.0, 0.2)).translate((13.3, 12.9, 3.02))
    middle = np.array(low.bounding_box()).reshape(2, 3).mean(axis=0)[:2]
    assert np.linalg.norm(middle - (15.3, 14.9)) < 0.4


def test_struts_as_beams_carry_teeth():
    part, _ = scene("slab")
    (support,) = supports("slab", KINDS["teeth"], "strut", beams=True, space=SPACE)
    assert support.lattice is not None
    assert judged("slab", (support,)) == []
    contact = solid_of(support.lattice.solids) ^ solid_of(part.mesh)
    assert contact.volume() == pytest.approx(64 * 0.25 * OVERLAP, rel=0.02)


def test_a_neck_as_wide_as_its_tooth_is_refused():
    with pytest.raises(JobError, match="neck_mm"):
        supports("slab", ConnectorRules("full", neck_mm=1.9))


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"connector": "teath"}, "'teeth'"),
        ({"tooth_width_mm": 0.0}, "tooth_width_mm must be at least 0.05"),
        ({"tooth_pitch_mm": 0.4}, "tooth_pitch_mm must be above the width of 0.5 mm"),
        ({"connector": "teeth", "neck_mm": 0.5}, "neck_mm must be below the tip width of 0.5 mm"),
        (
            {"connector": "point", "neck_mm": 0.3, "neck_height_mm": 1.0},
            "neck_height_mm must be below the tip height",
        ),
        ({"connector": "extend", "neck_mm": 0.3}, "neck_mm and perforation_mm need connector"),
        ({"perforation_mm": 0.01}, "perforation_mm must be 0 or at least 0.05"),
        ({"base": "pad"}, "'raft'"),
        ({"raft_height_mm": 0.0}, "raft_height_mm must be between 0.05 and 50"),
    ],
)
def test_wrong_connector_and_base_settings_are_refused_in_one_line(table, words):
    with pytest.raises(JobError) as error:
        make_job({"inputs": ["a.stl"], "cells": table}, name="a", folder=None, source="job")
    assert words in str(error.value)
    assert "\n" not in str(error.value)
