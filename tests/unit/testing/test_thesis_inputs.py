"""Inputs A to E have the sizes of the thesis's, and are what it says they are."""

import numpy as np
import pytest

from amprep.bench.routing.thesis_table import NODES
from amprep.model.supports import Voxel
from amprep.testing.support_scenes import count_graph
from amprep.testing.thesis_inputs import INPUTS, thesis_input


@pytest.mark.parametrize("name", INPUTS)
def test_an_input_has_as_many_nodes_as_the_thesis_states(name):
    nodes, edges = count_graph(thesis_input(name))
    assert nodes == pytest.approx(NODES[name], rel=0.031)
    assert 2.5 * nodes < edges < 5.0 * nodes


def test_b_is_two_copies_of_a():
    one, two = thesis_input("A"), thesis_input("B")
    assert len(two.red) == 2 * len(one.red)
    assert (two.voxels != Voxel.FREE).sum() == 2 * (one.voxels != Voxel.FREE).sum()
    left, right = np.split(two.voxels, 2, axis=2)
    assert np.array_equal(left, right)


def test_e_is_filled_by_objects_that_are_apart():
    voxels = thesis_input("E").voxels
    assert 0.15 < (voxels != Voxel.FREE).mean() < 0.5
    assert (voxels[:10] == Voxel.FREE).all()
    assert np.array_equal(voxels, thesis_input("E").voxels)
