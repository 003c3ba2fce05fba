"""Points and bodies inside others agree with winding numbers and with volumes of manifold3d."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.triangles import KINDS, SCENES, arrays, random_pose, shift, some_solid

from amprep.geometry.meshes.containment import inside
from amprep.geometry.trees.collision_mesh import collision_mesh
from amprep.geometry.trees.containment import contains_points, is_inside, solids_collide

HERE = np.eye(4)


def tree_of(solid):
    return collision_mesh(*arrays(solid))


@given(st.sampled_from(KINDS), st.integers(0, 2**32 - 1))
@examples(30)
def test_points_are_inside_where_the_winding_number_is_positive(kind, seed):
    rng = np.random.default_rng(seed)
    solid = some_solid(kind, rng)
    vertices, triangles = arrays(solid)
    points = rng.uniform(-7, 7, (200, 3))
    points[:50, :2] = vertices[rng.integers(len(vertices), size=50), :2]  # below and above vertices
    assert (contains_points(tree_of(solid), points) == inside(points, vertices, triangles)).all()


def test_a_point_straight_below_an_edge_or_a_vertex_is_decided():
    cube = tree_of(Manifold.cube((2, 2, 2), True))
    points = np.array(
        [[0, 0, 0], [0.5, 0.5, 0], [0.5, 0.5, 1.5], [0, 0, -1.5], [0, 0, 1.5], [-0.5, 0.5, 0.9]]
    )
    assert list(contains_points(cube, points)) == [True, True, False, False, False, True]


@given(SCENES)
@examples(40)
def test_solids_collide_where_their_intersection_has_volume(kinds):
    first, second, seed = kinds
    rng = np.random.default_rng(seed)
    one, other = some_solid(first, rng), some_solid(second, rng).scale([0.2] * 3)
    pose = random_pose(rng, 6.0)
    common = (one ^ other.transform(pose[:3])).volume()
    if common > 1e-6 or common == 0.0:
        assert solids_collide(tree_of(other), tree_of(one), pose, HERE)[0] == (common > 0)
        whole = abs(common - other.volume()) < 1e-9 * other.volume()
        assert is_inside(tree_of(other), tree_of(one), pose, HERE)[0] == whole


def test_a_body_in_a_cavity_is_neither_inside_nor_in_collision():
    shell = Manifold.cube((10, 10, 10), True) - Manifold.cube((6, 6, 6), True)
    hollow, ball = tree_of(shell), tree_of(Manifold.sphere(2.0, 16))
    assert not solids_collide(ball, hollow, HERE, HERE)[0]
    assert not solids_collide(hollow, ball, HERE, HERE)[0]
    assert not is_inside(ball, hollow, HERE, HERE)[0]
    assert solids_collide(ball, hollow, HERE, HERE, margin=1.5)[0]


def test_a_body_around_a_cavity_of_another_is_not_inside_it():
    hollow = tree_of(Manifold.cube((20, 20, 20), True) - Manifold.cube((1, 1, 1), True))
    ball = tree_of(Manifold.sphere(5.0, 16))
    assert solids_collide(ball, hollow, HERE, HERE)[0]
    assert not is_inside(ball, hollow, HERE, HERE)[0]
    assert is_inside(ball, tree_of(Manifold.cube((20, 20, 20), True)), HERE, HERE)[0]


@pytest.mark.parametrize("offset", [(2, 0, 0), (2, 2, 0), (2, 2, 2), (2, 0.5, 0.3)])
def test_cubes_that_touch_do_not_collide_as_solids(offset):
    cube = tree_of(Manifold.cube((2, 2, 2), True))
    assert not solids_collide(cube, cube, shift(*offset), HERE)[0]


def test_one_of_several_components_inside_is_a_collision():
    pair = Manifold.cube((1, 1, 1), True) + Manifold.cube((1, 1, 1), True).translate((20, 0, 0))
    block = tree_of(Manifold.cube((5, 5, 5), True))
    assert solids_collide(tree_of(pair), block, HERE, HERE)[0]
    assert solids_collide(block, tree_of(pair), HERE, HERE)[0]
    assert not is_inside(tree_of(pair), block, HERE, HERE)[0]
