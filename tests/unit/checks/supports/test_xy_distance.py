"""The XY distance between supports and walls of parts is exact on shapes known by hand and on slices of solids."""

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.checks.supports.xy_distance import check_xy_distance
from amprep.geometry.meshes.sampling import sample_triangles
from amprep.geometry.overhangs.carried.points import Limits
from amprep.geometry.overhangs.find import find_overhangs
from amprep.geometry.overhangs.limited import find_limited_overhangs
from amprep.geometry.supports.walls import PartWalls, occupancy_of, spaces_beside, wall_distance, walls_of
from amprep.model import Build, BuildSettings, BuildVolume, Mesh, Part, PlacedPart, Stop, SupportBody
from amprep.model.supports.rules import SupportRules

GAP = 0.5


def mesh_of(solid: Manifold) -> Mesh:
    mesh = solid.to_mesh64()
    return Mesh(np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts))


def box(lo, hi) -> Manifold:
    size = np.subtract(hi, lo).astype(float)
    return Manifold.cube(size.tolist()).translate(np.array(lo, float).tolist())


TABLE = box((0, 0, 10), (20, 20, 13)) + box((8, 8, 0), (12, 12, 10))
"""A slab on one square leg."""


def build_of(support: Manifold, part: Manifold = TABLE, gap: float = GAP, **settings) -> Build:
    mesh = mesh_of(part)
    placed = PlacedPart("table", Part("table", mesh, mesh.signed_volume), np.eye(4))
    rules = SupportRules(gap_mm=gap, **settings)
    made_under = BuildSettings("test", BuildVolume(np.array([50.0, 50.0, 50.0])), rules=rules)
    return Build(made_under, (placed,), (SupportBody("post", mesh_of(support), (0,)),))


def judged(*arguments, **settings) -> int:
    return len(check_xy_distance(build_of(*arguments, **settings), Stop()))


@pytest.mark.parametrize(("away", "faults"), [(0.45, 1), (0.55, 0), (0.0, 1)])
def test_a_post_up_to_the_slab_keeps_its_distance_from_the_leg(away, faults):
    post = box((12 + away, 9, 0), (15, 11, 10.1))
    assert judged(post) == faults
    assert judged(post, gap=0.0) == 0


def test_a_post_below_the_rim_of_the_slab_is_near_no_wall_because_it_holds_the_slab():
    assert judged(box((18, 18, 0), (20, 20, 10.1))) == 0


@pytest.mark.parametrize(("away", "faults"), [(0.3, 1), (0.7, 0)])
def test_a_post_beside_the_slab_keeps_its_distance_from_its_side_and_its_edge(away, faults):
    assert judged(box((20 + away, 9, 0), (22, 11, 12))) == faults
    corner = 20 + away / np.sqrt(2.0)
    assert judged(box((corner, corner, 0), (23, 23, 12))) == faults


def test_a_wall_behind_another_part_of_the_body_does_not_count():
    """The post holds a slope; the slope's side, right beside it, is no wall to what stands below the slope."""
    slope = box((0, 0, 0), (20, 20, 3)).rotate((0, -30, 0)).translate((0, 0, 5))
    post = box((8, 19, 0), (10, 20, 30)) - slope.translate((0, 0, 0.1)) - box((0, 0, 12), (20, 20, 40))
    pieces = [piece for piece in post.decompose() if piece.bounding_box()[2] < 0.1]
    assert judged(pieces[0], slope) == 0


def test_below_a_knife_edge_a_post_may_come_up_as_far_as_the_overlap():
    keel = Manifold.hull_points(
        np.array([[x, y, z] for x in (0.0, 20.0) for y, z in ((5, 10), (2, 18), (8, 18))])
    )
    assert judged(box((9, 4, 0), (11, 6, 10.1)), keel) == 0
    assert judged(box((9, 4, 0), (11, 6, 10.5)), keel) == 1


@pytest.mark.parametrize("seed", range(4))
def test_exactly_the_points_nearer_than_the_xy_distance_in_their_plane_are_cut_off(seed):
    """Against slices of a tumbled box, whose distance to a point is known by brute force; 2 % for the polygon."""
    rng = np.random.default_rng(seed)
    part = box((0, 0, 0), rng.uniform(1, 5, 3)).rotate(rng.uniform(0, 360, 3).tolist())
    mesh = mesh_of(part)
    nothing = find_overhangs(mesh.vertices, mesh.triangles, angle_deg=0.0)
    walls = walls_of(mesh.vertices, mesh.triangles, nothing, 0.0)
    space = spaces_beside(walls, GAP)
    low, high = mesh.bounds
    for z in rng.uniform(low[2], high[2], 3):
        outline = [np.array(each) for each in part.slice(z).to_polygons()]
        points = rng.uniform(low[:2] - 2 * GAP, high[:2] + 2 * GAP, (150, 2))
        away = np.min([distance_to(outline, points)], axis=0)
        inside = wall_side(outline, points)
        cut = np.zeros(len(points), bool)
        for solid in space:
            cut |= wall_side([np.array(each) for each in solid.slice(z).to_polygons()], points)
        assert cut[~inside & (away < GAP - 1e-6)].all()
        assert not cut[~inside & (away > 1.021 * GAP)].any()
        found, _ = wall_distance(np.column_stack([points, np.full(len(points), z)]), walls, GAP, 0.0)
        sure = ~inside & (np.abs(away - GAP) > 1e-6)
        np.testing.assert_allclose(found[sure], np.where(away < GAP, away, np.inf)[sure], atol=1e-7)


def distance_to(outlines, points):
    """Distance of points to polygons, by brute force."""
    found = np.full(len(points), np.inf)
    for outline in outlines:
        for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            along = np.clip((points - a) @ (b - a) / max((b - a) @ (b - a), 1e-12), 0, 1)
            found = np.minimum(found, np.linalg.norm(points - a - along[:, None] * (b - a), axis=1))
    return found


def wall_side(outlines, points):
    """Whether points are inside polygons, by crossings."""
    inside = np.zeros(len(points), bool)
    x, y = points.T
    for outline in outlines:
        for (ax, ay), (bx, by) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            if ay != by:
                inside ^= ((ay <= y) != (by <= y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    return inside


def test_no_triangle_near_a_box_is_missed():
    rng = np.random.default_rng(0)
    corners = rng.uniform(0, 40, (300, 1, 3)) + rng.uniform(-2, 2, (300, 3, 3))
    lo = rng.uniform(0, 40, (40, 3))
    hi = lo + rng.uniform(0, 3, (40, 3))
    aside = np.array([GAP, GAP, 0.0])
    low, high = corners.min(axis=1) - aside, corners.max(axis=1) + aside
    meets = ((low[:, None] <= hi) & (high[:, None] >= lo)).all(axis=2).any(axis=1)
    found = occupancy_of(lo, hi).near(corners, GAP)
    assert (found >= meets).all()
    assert found.sum() < 0.8 * len(corners)
    assert not occupancy_of(lo[:0], hi[:0]).near(corners, GAP).any()


def test_points_on_triangles_are_nowhere_farther_apart_than_their_spacing():
    rng = np.random.default_rng(1)
    corners = rng.uniform(0, 3, (20, 3, 3))
    points = sample_triangles(corners, 0.3)
    share = rng.dirichlet((1, 1, 1), 200)
    for triangle in corners:
        places = share @ triangle
        nearest = np.linalg.norm(places[:, None] - points[None], axis=2).min(axis=1)
        assert nearest.max() < 0.3


def test_level_faces_overhangs_and_upper_faces_that_supports_stand_on_are_no_walls():
    mesh = mesh_of(TABLE)
    needs = find_overhangs(mesh.vertices, mesh.triangles, angle_deg=45.0)
    walls = walls_of(mesh.vertices, mesh.triangles, needs, 0.1)
    assert len(walls.corners) > 0
    assert np.abs(np.linalg.norm(walls.outward, axis=1) - 1.0).max() < 1e-12
    assert (np.ptp(walls.corners[:, :, 2], axis=1) > 1.0).all()
    pyramid = mesh_of(Manifold.hull_points(np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 3]], float)))
    none = find_overhangs(pyramid.vertices, pyramid.triangles, angle_deg=0.0)
    assert len(walls_of(pyramid.vertices, pyramid.triangles, none, 0.1).corners) == 3
    sides = walls_of(pyramid.vertices, pyramid.triangles, none, 0.1, stood_on=True)
    assert len(sides.corners) == 2  # the two upright ones
    assert isinstance(sides, PartWalls)


SHED = Manifold.hull_points(np.array([[x, y, z] for y in (0.0, 6.0) for x, z in ((0, 10), (8, 16), (0, 20))]))
"""A roof that rises by 37 degrees, away from the wall that carries it."""


def test_faces_beside_overhangs_are_no_walls_because_contacts_extend_to_them():
    mesh = mesh_of(SHED + box((-3, 0, 0), (0, 6, 20)))
    vertices, triangles, needs = find_limited_overhangs(
        mesh.vertices, mesh.triangles, Limits(45.0, 1.0, 2.0, 8.0, 0.05, 0.04)
    )
    assert len(needs.faces) > 0
    assert vertices[triangles[needs.beside]][:, :, 0].min() == pytest.approx(0.0, abs=1e-9)
    walls = walls_of(vertices, triangles, needs, 0.1).corners
    normal = np.cross(walls[:, 1] - walls[:, 0], walls[:, 2] - walls[:, 0])
    assert (normal[:, 2] > -0.7 * np.linalg.norm(normal, axis=1)).all()
    assert len(walls) > 0


@pytest.mark.parametrize(("begins", "faults"), [(0.55, 0), (0.3, 1)])
def test_a_post_that_extends_to_faces_beside_an_overhang_keeps_its_distance_from_the_wall_alone(
    begins, faults
):
    part = SHED + box((-3, 0, 0), (0, 6, 20))
    post = box((begins, 2, 0), (4, 4, 14)) - SHED.translate((0, 0, 0.1))
    (post,) = (piece for piece in post.decompose() if piece.bounding_box()[2] < 0.1)
    assert judged(post, part, rules="limits", ledge_mm=1.0, bridge_mm=2.0, bore_mm=8.0) == faults


def test_the_judge_finds_unclipped_supports_and_accepts_clipped_ones():
    post, table = box((12, 9, 0), (15, 11, 10.1)), mesh_of(TABLE)
    build = build_of(post)
    assert len(check_xy_distance(build, Stop())) == 1
    needs = find_overhangs(table.vertices, table.triangles, angle_deg=45.0)
    for solid in spaces_beside(walls_of(table.vertices, table.triangles, needs, 0.1), GAP):
        post -= solid
    trimmed = replace(build.supports[0], mesh=mesh_of(post))
    assert check_xy_distance(replace(build, supports=(trimmed,)), Stop()) == []
    assert post.volume() == pytest.approx(2.5 * 2 * 10.1, rel=0.01)
