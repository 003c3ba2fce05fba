"""Voxelisation against exact intersection volumes, and on shapes whose faces lie on grid planes."""

import manifold3d
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.meshes.containment import inside
from amprep.geometry.overhangs.find import find_overhangs
from amprep.geometry.voxels.grid import Grid
from amprep.geometry.voxels.voxelise import UNMARKED, holding_voxels, met_voxels, near_voxels

Solid = manifold3d.Manifold
TOLERANCE = 1e-3


def arrays(solid):
    mesh = solid.to_mesh()
    return np.asarray(mesh.vert_properties[:, :3], float), np.asarray(mesh.tri_verts, np.int32)


def whole(shape, pitch=1.0, step=1.0, origin=(0, 0, 0)):
    grid = Grid(np.array(origin, float), pitch, step, shape)
    return grid.block(grid.origin - 9, grid.origin + 1e3)


def marked(array):
    return {tuple(index) for index in np.argwhere(array).tolist()}


def block(z, y, x):
    return {(k, j, i) for k in range(*z) for j in range(*y) for i in range(*x)}


@pytest.mark.parametrize("noise", [0.0, 5e-4, -5e-4])
def test_a_box_on_grid_planes_marks_its_own_cubes_and_no_neighbour(noise):
    vertices, triangles = arrays(Solid.cube((2, 3, 1)).translate((1, 1, 2)))
    found = met_voxels(whole((5, 6, 5)), vertices + noise, triangles)
    assert marked(found) == block((2, 3), (1, 4), (1, 3))


def test_a_penetration_of_more_than_the_tolerance_counts():
    vertices, triangles = arrays(Solid.cube((2, 3, 1)).translate((1, 1, 2)))
    found = met_voxels(whole((5, 6, 5)), np.add(vertices, (0, 0, 0.002)), triangles)
    assert marked(found) == block((2, 4), (1, 4), (1, 3))


def test_the_inside_counts_and_a_cavity_does_not():
    shell = Solid.cube((7, 7, 7)) - Solid.cube((3, 3, 3)).translate((2, 2, 2))
    found = met_voxels(whole((7, 7, 7)), *arrays(shell))
    assert marked(~found) == block((2, 5), (2, 5), (2, 5))
    surface = met_voxels(whole((7, 7, 7)), *arrays(Solid.cube((6.5, 6.5, 6.5))), solid=False)
    assert not surface[1:6, 1:6, 1:6].any()
    assert surface[6].all()


def test_overlapping_shells_count_as_their_union():
    (a, s), (b, t) = (arrays(Solid.cube((4, 4, 4)).translate((x, 0, 0))) for x in (0, 2))
    found = met_voxels(whole((4, 4, 8)), np.concatenate([a, b]), np.concatenate([s, t + len(a)]))
    assert marked(found) == block((0, 4), (0, 4), (0, 6))


def test_what_sticks_out_of_the_grid_is_left_out():
    vertices, triangles = arrays(Solid.cube((30, 30, 30)).translate((-10, -10, -10)))
    assert met_voxels(whole((3, 4, 5)), vertices, triangles).all()
    assert not met_voxels(whole((3, 4, 5)), vertices + 100, triangles).any()


def random_solid(seed):
    rng = np.random.default_rng(seed)
    kind = seed % 3
    angles = tuple(rng.uniform(0, 360, 3))
    if kind == 0:
        solid = Solid.hull_points(rng.uniform(-2.5, 2.5, (8, 3)))
    elif kind == 1:
        solid = Solid.cube((3, 2, 2.5), True).rotate(angles) - Solid.cylinder(6, 0.7, 0.7, 8, True).rotate(
            angles
        )
    else:
        solid = Solid.sphere(2, 12) + Solid.cube((0.3, 0.3, 5), True).rotate(angles)
    return solid.translate(tuple(rng.uniform(2.2, 3.2, 3)))


def judge_by_volume(solid, found, pitch, step):
    """A voxel shrunk by the tolerance is met when its common volume with the solid is not nil."""
    for k, y, x in np.ndindex(found.shape):
        shrunk = Solid.cube((pitch - 2 * TOLERANCE, pitch - 2 * TOLERANCE, step - 2 * TOLERANCE))
        voxel = shrunk.translate((x * pitch + TOLERANCE, y * pitch + TOLERANCE, k * step + TOLERANCE))
        volume = (solid ^ voxel).volume()
        if volume > 1e-9 or volume == 0.0:  # in between rounding decides
            assert found[k, y, x] == (volume > 0), (k, y, x, volume)


@examples(25)
@given(st.integers(0, 10_000), st.sampled_from([(1.0, 1.0), (0.8, 1.3), (1.1, 0.7)]))
def test_met_voxels_are_those_with_a_common_volume(seed, sizes):
    pitch, step = sizes
    solid = random_solid(seed)
    found = met_voxels(whole((5, 5, 5), pitch, step), *arrays(solid))
    judge_by_volume(solid, found, pitch, step)


def test_rotated_to_lie_on_grid_planes_with_noise_the_judge_still_agrees():
    solid = Solid.cube((2, 2, 2), True).rotate((0, 0, 90)).rotate((90, 0, 0)).translate((2, 2, 2))
    found = met_voxels(whole((4, 4, 4)), *arrays(solid))
    assert marked(found) == block((1, 3), (1, 3), (1, 3))


def held(solid, shape=(8, 8, 8), angle_deg=45.0):
    vertices, triangles = arrays(solid)
    found = find_overhangs(vertices, triangles, angle_deg=angle_deg)
    return holding_voxels(whole(shape), vertices, triangles, found)


def test_a_face_on_a_grid_plane_belongs_to_the_cube_above():
    labels = held(Solid.cube((2, 3, 1)).translate((1, 1, 2)))
    assert marked(labels != UNMARKED) == block((2, 3), (1, 4), (1, 3))
    lower = held(Solid.cube((2, 3, 1)).translate((1, 1, 2 - 5e-4)))
    assert marked(lower != UNMARKED) == block((2, 3), (1, 4), (1, 3))


def test_an_edge_on_an_upright_plane_belongs_to_both_sides_and_a_tip_to_its_voxel():
    roof = [(0.2, 2, 1.5), (3.8, 2, 1.5)] + [(x, y, 4) for x in (0.2, 3.8) for y in (1, 3)]
    labels = held(Solid.hull_points(roof))
    assert marked(labels != UNMARKED) == block((1, 2), (1, 3), (0, 4))
    tip = held(Solid.cylinder(3, 0, 0.5, 8).translate((2.5, 2.5, 1)))
    assert marked(tip != UNMARKED) == {(1, 2, 2)}


def test_each_cube_gets_the_least_region_it_holds():
    two = Solid.cube((0.4, 1, 1)).translate((0.1, 0, 1)) + Solid.cube((0.4, 1, 1)).translate((0.6, 0, 1))
    labels = held(two, shape=(3, 1, 1))
    assert labels[:, 0, 0].tolist() == [UNMARKED, 0, UNMARKED]


def test_near_voxels_reach_sideways_by_the_gap_only():
    vertices, triangles = arrays(Solid.cube((1, 1, 1)).translate((3, 3, 3)))
    assert marked(near_voxels(whole((8, 7, 7)), vertices, triangles, 1.5)) == block((3, 4), (1, 6), (1, 6))
    assert marked(near_voxels(whole((8, 7, 7)), vertices, triangles, 1.0)) == block((3, 4), (2, 5), (2, 5))


@examples(30)
@given(st.integers(0, 10_000))
def test_inside_agrees_with_the_solid_angle(seed):
    vertices, triangles = arrays(random_solid(seed))
    points = np.random.default_rng(seed).uniform(-0.5, 6, (60, 3))
    a, b, c = (vertices[triangles[:, i]][None] - points[:, None] for i in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=2) for side in (a, b, c))
    above = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    below = la * lb * lc + np.einsum("ijk,ijk->ij", a, b) * lc
    below += np.einsum("ijk,ijk->ij", b, c) * la + np.einsum("ijk,ijk->ij", c, a) * lb
    winding = np.arctan2(above, below).sum(axis=1) / (2 * np.pi)
    assert inside(points, vertices, triangles).tolist() == (winding > 0.5).tolist()


def test_inside_of_aligned_shapes_is_exact_on_shared_edges():
    """Lines through vertices, along edges and diagonals of a box cross its bottom and top once each."""
    vertices, triangles = arrays(Solid.cube((4, 4, 4)))
    points = np.array([(x, y, z) for x in (1, 2, 3) for y in (1, 2, 3) for z in (-1, 1, 5)], float)
    assert inside(points, vertices, triangles).tolist() == (points[:, 2] == 1).tolist()
