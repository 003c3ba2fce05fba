"""OBB trees: every box contains its triangles, every triangle has one leaf, and splits stop for any mesh."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.triangles import KINDS, arrays, some_solid

from amprep.geometry.meshes.containment import inside
from amprep.geometry.trees.collision_mesh import collision_mesh
from amprep.model import Mesh, Solid


def triangles_below(tree, node):
    """Triangles of the leaves below a node, in the order of the leaves."""
    if tree.link[node] < 0:
        return [-1 - tree.link[node]]
    left = tree.link[node]
    return triangles_below(tree, left) + triangles_below(tree, left + 1)


@given(st.sampled_from(KINDS), st.integers(0, 2**32 - 1), st.sampled_from([1e-3, 1.0, 1e3]))
@examples(20)
def test_every_box_contains_the_triangles_of_its_leaves(kind, seed, scale):
    vertices, triangles = arrays(some_solid(kind, np.random.default_rng(seed)).scale([scale] * 3))
    tree = collision_mesh(vertices + 100.0 * scale, triangles).tree
    for node, row in enumerate(tree.nodes):
        below = triangles_below(tree, node)
        assert below == list(range(below[0], below[0] + len(below)))
        points = tree.corners[below].reshape(-1, 3)
        axes = row[6:15].reshape(3, 3)
        assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
        assert (np.abs((points - row[:3]) @ axes.T) <= row[3:6] + 1e-12 * scale).all()
        assert row[15] == pytest.approx(np.linalg.norm(row[3:6]))


@given(st.sampled_from(KINDS), st.integers(0, 2**32 - 1))
@examples(20)
def test_every_cone_contains_the_normals_of_its_triangles(kind, seed):
    tree = collision_mesh(*arrays(some_solid(kind, np.random.default_rng(seed)))).tree
    for node, (*axis, sine) in enumerate(tree.cones):
        normals = tree.normals[triangles_below(tree, node)]
        if sine <= 1.0:
            assert (normals @ axis >= np.sqrt(1.0 - sine * sine) - 1e-12).all()
        else:
            assert sine == 2.0


def test_the_leaves_are_the_triangles_of_the_mesh():
    vertices, triangles = arrays(Manifold.sphere(5.0, 24))
    body = collision_mesh(vertices, triangles)
    assert sorted(body.tree.order) == list(range(len(triangles)))
    assert len(body.tree.nodes) == 2 * len(triangles) - 1
    assert (body.triangles == vertices[triangles]).all()


def test_the_first_box_of_a_long_box_has_its_directions():
    turned = Manifold.cube((20, 4, 1), True).rotate((10, 20, 30))
    tree = collision_mesh(*arrays(turned)).tree
    assert sorted(tree.nodes[0, 3:6]) == pytest.approx([0.5, 2.0, 10.0])


def test_a_tree_is_about_as_deep_as_its_triangles_require():
    vertices, triangles = arrays(Manifold.sphere(5.0, 64))
    assert collision_mesh(vertices, triangles).tree.depth <= 2 * np.log2(len(triangles))


def test_triangles_that_no_plane_divides_are_halved():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    tree = collision_mesh(vertices, np.tile([0, 1, 2], (64, 1))).tree
    assert tree.depth == 6
    assert sorted(tree.order) == list(range(64))


def test_triangles_without_area_have_boxes_too():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 2, 2]])
    tree = collision_mesh(vertices, np.array([[0, 1, 2], [3, 3, 3], [0, 0, 1]])).tree
    assert np.isfinite(tree.nodes).all()


def test_each_component_has_a_sample_on_it_and_one_in_the_solid():
    hollow = Manifold.cube((4, 4, 4)) - Manifold.cube((2, 2, 2)).translate((1, 1, 1))
    two = hollow + Manifold.cube((1, 1, 1)).translate((9, 0, 0))
    samples = collision_mesh(*arrays(two)).tree.samples
    assert len(samples) == 3
    assert inside(samples[:, 3:], *arrays(two)).all()
    assert sorted(samples[:, 0] > 5) == [False, False, True]


def test_the_arrays_of_a_tree_are_read_only():
    tree = collision_mesh(*arrays(Manifold.cube((1, 1, 1)))).tree
    assert not any(each.flags.writeable for each in tree if isinstance(each, np.ndarray))


def test_a_solid_builds_its_tree_once():
    solid = Solid(Mesh(*arrays(Manifold.cube((1, 1, 1)))))
    assert solid.collision_mesh is solid.collision_mesh
    assert len(solid.collision_mesh.tree.corners) == 12
