"""A box tree holds every triangle of its mesh once, inside the boxes of all nodes above it, at every placement."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.meshes.box_tree import LEAF, box_tree


@examples(20)
@given(st.integers(0, 10**6), st.integers(1, 300))
def test_every_triangle_is_in_one_leaf_and_in_the_boxes_above_it(seed, count):
    rng = np.random.default_rng(seed)
    vertices, triangles = rng.uniform(-5, 5, (60, 3)), rng.integers(0, 60, (count, 3))
    tree = box_tree(vertices, triangles)
    moved = rng.uniform(-50, 50, (60, 3))
    corners, starts, boxes, sizes = tree.placed(moved)
    assert sorted(map(tuple, corners)) == sorted(map(tuple, moved[triangles].reshape(-1, 9)))
    assert starts[0] == 0
    assert starts[-1] == count
    assert (np.diff(starts) >= 1).all()
    assert (np.diff(starts) <= LEAF).all()
    leaves = len(starts) - 1
    for leaf in range(leaves):
        points = corners[starts[leaf] : starts[leaf + 1]].reshape(-1, 3)
        node = leaves - 1 + leaf
        while True:
            assert (points >= boxes[node, :3]).all()
            assert (points <= boxes[node, 3:]).all()
            if node == 0:
                break
            node = (node - 1) // 2
    assert sizes == pytest.approx((boxes[:, 3:] - boxes[:, :3]).sum(axis=1))


def test_each_component_of_the_surface_has_one_vertex():
    one = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    vertices = np.vstack([np.eye(4, 3), np.eye(4, 3) + 9.0])
    tree = box_tree(vertices, np.vstack([one, one + 4]))
    assert sorted(tree.shell_vertices // 4) == [0, 1]
