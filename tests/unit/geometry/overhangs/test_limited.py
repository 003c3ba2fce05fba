"""What the part itself carries, on shapes whose verdicts are known by construction."""

import manifold3d
import numpy as np
import pytest
from tests.shared.solids import mesh_of

from amprep.geometry.overhangs.carried.points import Limits
from amprep.geometry.overhangs.limited import find_limited_overhangs

Solid = manifold3d.Manifold
TOLERANT = Limits(45.0, 2.0, 4.0, 10.0, 0.06, 0.04)


def box(size, corner=(0, 0, 0)):
    return Solid.cube(size).translate(corner)


def found(solid, limits=TOLERANT):
    mesh = mesh_of(solid)
    return find_limited_overhangs(mesh.vertices, mesh.triangles, limits)


def ledge(length):
    return box((10, 10, 20)) + box((length + 5, 10, 5), (5, 0, 15))


def areas(result, faces):
    a, b, c = np.moveaxis(result.vertices[result.triangles[faces]], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


@pytest.mark.parametrize(("length", "carried"), [(0.2, True), (2.0, True), (2.1, False), (6.0, False)])
def test_a_ledge_is_carried_up_to_its_limit(length, carried):
    (region,) = found(ledge(length)).overhangs.regions
    assert (region.kind, region.is_self_supporting) == ("ledge", carried)
    assert region.size_mm == pytest.approx(length, abs=0.05)


def test_only_what_is_beyond_the_limit_needs_support():
    result = found(ledge(6.0))
    needed = result.overhangs.faces
    assert areas(result, needed).sum() == pytest.approx(40.0, abs=0.3 * 10)
    assert areas(result, np.concatenate([needed, result.overhangs.beside])).sum() == pytest.approx(60.0)
    assert result.vertices[result.triangles[needed], 0].min() > 12.0 - 0.4


def test_the_mesh_that_is_subdivided_at_the_limits_is_still_closed():
    result = found(ledge(6.0))
    assert len(result.triangles) > 24
    solid = manifold3d.Manifold(
        manifold3d.Mesh(result.vertices.astype(np.float32), result.triangles.astype(np.uint32))
    )
    assert solid.status() == manifold3d.Error.NoError
    assert solid.volume() == pytest.approx(2000 + 300, rel=1e-4)


def ring(radius, z, sides, phase=0.0):
    angle = 2 * np.pi * (np.arange(sides) + phase) / sides
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(sides, z)])


def countersunk(lift):
    """A block above the plate with a countersink of which every other triangle is a little flatter than 45 degrees."""
    sink = Solid.hull_points(np.concatenate([ring(4, lift, 48), ring(3, lift + 1, 48, 0.5)]))
    hole = Solid.hull_points(np.concatenate([ring(3, lift, 48, 0.5), ring(3, lift + 20, 48, 0.5)]))
    return box((20, 20, 10), (-10, -10, lift)) - sink - hole


def test_only_the_underside_of_a_lifted_part_needs_support_if_its_countersink_carries_itself():
    result = found(countersunk(3.0))
    assert np.ptp(result.vertices[result.triangles[result.overhangs.faces], 2]) == 0.0
    starting = [each for each in result.overhangs.regions if each.starts_in_air]
    assert [(each.kind, each.size_mm) for each in starting] == [("flat", 0.0)]
    assert starting[0].measure == pytest.approx(400 - 48 * 8 * np.sin(np.pi / 24), rel=1e-4)
    others = [each for each in result.overhangs.regions if not each.starts_in_air]
    assert len(others) >= 48
    assert all(each.is_self_supporting for each in others)


@pytest.mark.parametrize(("width", "side", "carried"), [(1.3, 10, True), (3.0, 10, False), (1.3, 0.8, False)])
def test_a_level_start_carries_a_chamfer_beside_it_up_to_a_ledge_if_it_is_wide(width, side, carried):
    rise = width * np.tan(np.radians(30))
    far = side / 2 + width
    foot = Solid.hull_points(
        np.array(
            [(x * h, y * h, z) for h, z in ((side / 2, 3), (far, 3 + rise)) for x in (-1, 1) for y in (-1, 1)]
        )
    )
    result = found(foot + box((2 * far, 2 * far, 5), (-far, -far, 3 + rise)))
    heights = result.vertices[result.triangles[result.overhangs.faces], 2]
    assert heights.min() == pytest.approx(3.0)
    assert (heights.max() < 3.0 + 1e-6) == carried


def test_of_a_bore_with_a_burr_only_the_burr_needs_support():
    bore = box((20, 20, 20), (-10, -10, 0)) - Solid.cylinder(30, 3, 3, 64, True).rotate((90, 0, 0)).translate(
        (0, 0, 10)
    )
    base = [(x, y, 13.05) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    result = found(bore + Solid.hull_points(np.array([*base, (0.0, 0.0, 12.7)])))
    (region,) = [each for each in result.overhangs.regions if each.starts_in_air]
    assert 0.2 < region.measure < 2.0
    needed = result.vertices[result.triangles[result.overhangs.faces]]
    assert np.abs(needed[:, :, :2]).max() < 1.2
    assert needed[:, :, 2].min() == pytest.approx(12.7)


def keel(length, both=False):
    """An arm between one or two posts with a knife edge below, at the height of 14 mm."""
    arm = Solid.hull_points(
        np.array([(x, y, z) for x in (-1, length + 1) for y, z in ((0, 14), (-2, 18), (2, 18))])
    )
    posts = box((10, 10, 20), (-10, -5, 0))
    if both:
        posts += box((10, 10, 20), (length, -5, 0))
    else:
        arm = arm.trim_by_plane((-1, 0, 0), -length)
    return posts + arm


@pytest.mark.parametrize(("both", "start", "end"), [(False, 2, 7), (True, 2, 5)])
def test_of_a_knife_edge_only_what_is_beyond_the_limit_needs_support(both, start, end):
    result = found(keel(7.0, both))
    own = [each for each in result.overhangs.regions if each.kind == "edge" and not each.is_self_supporting]
    assert [each.measure for each in own] == pytest.approx([end - start])
    along = np.sort(result.vertices[result.overhangs.edges, 0].ravel())
    assert along[[0, -1]] == pytest.approx([start, end])
