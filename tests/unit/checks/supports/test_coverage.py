"""Coverage: what is held, what is listed, and what the judge finds when it is neither."""

from dataclasses import replace

import manifold3d
import numpy as np
import pytest

from amprep.checks.supports.coverage import check_coverage
from amprep.geometry.meshes.sampling import sample_overhangs, sample_segments
from amprep.geometry.overhangs.find import find_overhangs
from amprep.model import (
    Build,
    BuildSettings,
    BuildVolume,
    Mesh,
    Overrides,
    Part,
    PlacedPart,
    SupportBody,
    Unsupported,
)
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.contacts import sample_spacing
from amprep.overhangs.of_part import overhangs_of
from amprep.overhangs.unsupported import find_unsupported

Solid = manifold3d.Manifold
SETTINGS = BuildSettings("b.build-1", BuildVolume([60, 60, 60]), reach=1.5, overlap=0.1)
REASON = "no free voxel below"


def box(size, corner):
    return Solid.cube(size).translate(corner)


def mesh_of(solid):
    mesh = solid.to_mesh()
    return Mesh(mesh.vert_properties[:, :3], mesh.tri_verts)


def part_of(solid, **settings):
    return PlacedPart("table", Part("table", mesh_of(solid), solid.volume(), **settings), np.eye(4))


TABLE = part_of(box((20, 20, 3), (0, 0, 10)) + box((4, 4, 10), (8, 8, 0)))


def body(solid, surface=False):
    return SupportBody("s", solid if surface else mesh_of(solid), (0,), surface)


def reasons(part, points):
    return [REASON] * len(points)


def judged(*bodies, parts=(TABLE,), unsupported=(), **settings):
    return check_coverage(Build(replace(SETTINGS, **settings), parts, bodies, unsupported))


def listed(*bodies, parts=(TABLE,), **settings):
    rules = SupportRules(**settings)
    overhangs = [overhangs_of(part, rules) for part in parts]
    return find_unsupported(parts, overhangs, bodies, replace(SETTINGS, rules=rules), reasons)


def test_a_support_under_everything_covers_everything():
    full = body(box((20, 20, 10.1), (0, 0, 0)))
    assert listed(full) == ()
    assert judged(full) == []


def test_without_supports_everything_is_listed_with_its_area_reason_and_label():
    (region,) = listed()
    assert (region.part, region.kind, region.reason) == (0, "face", REASON)
    assert region.label == "overhang 1 of table"
    assert region.measure == pytest.approx(400 - 16, rel=0.01)
    assert judged(unsupported=(region,)) == []
    (violation,) = judged()
    assert violation.subject == "table"
    assert "an overhanging face of table" in violation.message


def test_half_a_support_leaves_the_other_half_less_the_reach():
    half = body(box((10, 20, 10.1), (0, 0, 0)))
    (region,) = listed(half)
    assert region.measure == pytest.approx((10 - 1.5) * 20 - 4 * 0.5, rel=0.06)
    assert region.points[:, 0].min() > 11.4
    assert judged(half, unsupported=(region,)) == []
    assert len(judged(half)) == 1


def test_a_support_that_stops_short_of_the_face_holds_nothing():
    short = body(box((20, 20, 9.9), (0, 0, 0)))
    assert len(judged(short)) == 1
    touching = body(box((20, 20, 10.0), (0, 0, 0)))
    assert judged(touching) == []


def test_a_strip_that_only_samples_on_the_rim_meet_is_measured_and_is_not_minor():
    almost = body(box((18.4, 20, 10.1), (0, 0, 0)))
    (region,) = listed(almost, min_area_mm2=0.5)
    assert region.points[:, 0].min() == 20.0
    assert 0.1 * 20 <= region.measure <= 0.3 * 20
    assert not region.minor


def test_the_number_of_samples_is_bounded_whatever_the_reach():
    wide = PlacedPart("wide", Part("wide", mesh_of(box((900, 900, 3), (0, 0, 10))), 1.0), np.eye(4))
    assert sample_spacing(wide, (), replace(SETTINGS, reach=0.05)) == pytest.approx(900 / 2e6**0.5)
    assert sample_spacing(TABLE, (), SETTINGS) == pytest.approx(0.5)


def grid_of_posts(spacing, width=0.1):
    return [
        box((width, width, 10.1), (x, y, 0))
        for x in np.arange(0, 20, spacing)
        for y in np.arange(0, 20, spacing)
    ]


def test_thin_posts_hold_what_is_within_reach_of_them():
    close = (
        Solid.compose(grid_of_posts(2.0))
        + box((20, 0.2, 10.1), (0, 19.8, 0))
        + box((0.2, 20, 10.1), (19.8, 0, 0))
    )
    assert judged(body(close)) == []
    wide = Solid.compose(grid_of_posts(4.0))
    assert len(judged(body(wide))) == 1


@pytest.mark.parametrize(("reach", "faults"), [(None, 0), (1.5, 0), (1.0, 1)])
def test_what_a_support_holds_is_judged_by_its_own_reach(reach, faults):
    left, right = body(box((10, 20, 10.1), (0, 0, 0))), body(box((7.6, 20, 10.1), (12.4, 0, 0)))
    pair = [replace(each, reach=reach) for each in (left, right)]
    assert [len(judged(*pair)), len(listed(*pair))] == [faults, faults], "judge and planner agree"
    between = body(box((0.5, 20, 10.1), (11.2, 0, 0)))
    assert judged(*pair, between) == [], "a body with a larger reach holds what others do not"


def wall(x):
    return [(x, 0, 0), (x, 20, 0), (x, 20, 10.1), (x, 0, 10.1)]


def test_walls_without_thickness_hold_by_their_upper_ends():
    corners = np.array([point for x in np.linspace(0.1, 19.9, 11) for point in wall(x)])
    quads = np.arange(len(corners)).reshape(-1, 4)
    sheet = Mesh(corners, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))
    assert judged(body(sheet, surface=True)) == []
    assert len(judged(body(Mesh(sheet.vertices - (0, 0, 0.2), sheet.triangles), surface=True))) == 1


def test_what_rests_on_the_plate_is_held_by_it():
    vertices = [
        (0, 0, 0),
        (10, 0, 0),
        (0, 10, 0),
        (10, 10, 0),
        (0, 0, 8),
        (14, 0, 2),
        (0, 10, 8),
        (14, 10, 2),
    ]
    lip = part_of(Solid.hull_points(np.array(vertices, float)))  # its lip rises at 26.6 degrees from x = 10
    (region,) = listed(parts=(lip,))
    assert region.points[:, 0].min() > 10 + 1.5 * np.cos(np.arctan(0.5)) - 0.1


def test_knife_edges_and_tips_must_be_held_too():
    voxel = Solid.cube((10, 10, 10), True).rotate((45, 0, 0)).translate((30, 30, 12))
    cone = Solid.cylinder(20, 0, 5, 24).translate((10, 10, 4))
    parts = (part_of(voxel), part_of(cone))
    found = listed(parts=parts)
    assert [(each.part, each.kind) for each in found] == [(0, "edge"), (1, "tip")]
    assert found[0].measure == pytest.approx(10.0)
    assert found[1].measure == 0.0
    z = 12 - np.sqrt(50)
    under_edge = body(box((10, 0.4, z + 0.1), (25, 29.8, 0)))
    under_tip = body(box((0.4, 0.4, 4.1), (9.8, 9.8, 0)))
    assert judged(under_edge, under_tip, parts=parts) == []


def test_a_listed_region_excuses_its_own_part_and_place_only():
    here = Unsupported(0, "o", "face", REASON, 1.0, [[10.0, 10.0, 10.0]], 50.0)
    assert judged(unsupported=(here,)) == []
    assert len(judged(unsupported=(replace(here, part=1),))) == 1
    assert len(judged(unsupported=(replace(here, radius=3.0),))) == 1


def test_parts_and_jobs_without_supports_need_none():
    free = part_of(box((5, 5, 5), (0, 0, 10)), overrides=Overrides(supports=False))
    assert judged(parts=(free,)) == []
    assert judged(supported=False) == []
    assert judged(parts=()) == []


def test_samples_leave_no_point_of_a_face_far_away():
    rng = np.random.default_rng(2)
    solid = Solid.sphere(7, 40).translate((10, 10, 12))
    mesh = mesh_of(solid)
    found = find_overhangs(mesh.vertices, mesh.triangles, angle_deg=45)
    samples = sample_overhangs(mesh.vertices, mesh.triangles, found, 0.5)
    corners = mesh.vertices[mesh.triangles[found.faces]]
    weights = rng.dirichlet((1, 1, 1), len(corners))
    points = np.einsum("ij,ijk->ik", weights, corners)
    distance = np.linalg.norm(points[:, None] - samples.points[None], axis=2).min(axis=1)
    assert distance.max() <= 0.5 + 1e-9
    assert samples.inner.sum() == pytest.approx(np.pi * 7**2 / 2 / 0.25, rel=0.08)
    assert len(samples.points) == len(samples.region)


def test_segments_are_sampled_with_both_ends():
    points, owner = sample_segments(np.zeros((2, 3)), np.array([[1.0, 0, 0], [0, 0, 0]]), 0.4)
    assert points[:, 0].tolist() == pytest.approx([0, 1 / 3, 2 / 3, 1, 0, 0])
    assert owner.tolist() == [0, 0, 0, 0, 1, 1]


def minor_of(*bodies, parts=(TABLE,), **settings):
    return [region for region in listed(*bodies, parts=parts, **settings) if region.minor]


def test_a_bare_corner_below_the_smallest_area_is_listed_as_minor():
    """A support that leaves a corner: what lies beyond the reach of it is a triangle of about 2 mm2."""
    most = body(box((20, 20, 10.1), (0, 0, 0)) - box((3.2, 3.2, 20), (16.8, 16.8, -1)))
    (region,) = listed(most, min_area_mm2=4.0)
    assert region.minor
    assert 0 < region.measure < 4.0
    assert region.reason == REASON
    (fault,) = listed(most, min_area_mm2=0.5)
    assert not fault.minor
    assert judged(most, unsupported=(region,)) == [], "what is listed breaks no promise, minor or not"


def test_patches_are_measured_one_by_one():
    corners = box((3.2, 3.2, 20), (16.8, 16.8, -1)) + box((3.2, 3.2, 20), (0, 0, -1))
    most = body(box((20, 20, 10.1), (0, 0, 0)) - corners)
    one = body(box((20, 20, 10.1), (0, 0, 0)) - box((3.2, 3.2, 20), (16.8, 16.8, -1)))
    (region,), (half,) = listed(most, min_area_mm2=5.0), listed(one, min_area_mm2=5.0)
    assert region.minor
    assert region.measure == pytest.approx(2 * half.measure, rel=0.5)


def test_a_small_patch_that_starts_in_the_air_is_never_minor():
    """A stud below the table: its bottom is small and lower than anything held near it."""
    table = part_of(
        box((20, 20, 3), (0, 0, 10)) + box((4, 4, 10), (8, 8, 0)) + box((1.9, 1.9, 3), (18, 18, 7.5))
    )
    held = body(box((20, 20, 10.1), (0, 0, 0)) - box((6, 6, 20), (14, 14, -1)))
    stud = [region for region in listed(held, parts=(table,), min_area_mm2=30.0) if region.measure < 4.0]
    assert stud
    assert not any(region.minor for region in stud)


def test_tips_are_never_minor():
    tip = mesh_of(Solid.extrude(manifold3d.CrossSection.square((4, 4), center=True), 9.0, scale_top=(0, 0)))
    upside_down = part_of(_flipped(tip))
    found = [
        region
        for region in listed(parts=(upside_down,), min_area_mm2=50, min_length_mm=50)
        if region.kind == "tip"
    ]
    assert found
    assert not any(region.minor for region in found)


def _flipped(mesh):
    points = np.array(mesh.vertices) * (1, 1, -1) + (0, 0, 12)
    return manifold3d.Manifold(
        manifold3d.Mesh(points.astype(np.float32), np.array(mesh.triangles)[:, ::-1].astype(np.uint32))
    )
