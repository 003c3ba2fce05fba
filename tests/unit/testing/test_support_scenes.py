"""The named support scenes have the sizes of the thesis and correct red squares."""

import numpy as np
import pytest

from amprep.errors import InputError
from amprep.model.supports import Voxel
from amprep.testing.support_scenes import SCENES, SIDES, count_graph, support_scene

THESIS_NODES = {"A": 8_196, "B": 27_670, "C": 62_708, "D": 1_110_380, "E": 6_424_582}


@pytest.mark.parametrize("size", SIDES)
def test_grid_sizes_are_those_of_the_thesis_within_5_percent(size):
    n = SIDES[size]
    assert (n + 1) * n**2 == pytest.approx(THESIS_NODES[size], rel=0.05)


@pytest.mark.parametrize("name", SCENES)
def test_red_squares_are_between_an_occupied_voxel_and_a_free_one_below(name):
    task = support_scene(name, 30)
    plane, y, x = task.red.T
    assert len(plane) > 50
    assert (task.voxels[plane, y, x] == Voxel.OCCUPIED).all()
    assert (task.voxels[plane - 1, y, x] == Voxel.FREE).all()


def test_a_ball_has_the_volume_of_a_ball():
    assert (support_scene("ball", 40).voxels == Voxel.OCCUPIED).mean() == pytest.approx(
        4 / 3 * np.pi * 0.28**3, rel=0.02
    )


def test_an_empty_grid_has_the_squares_and_edges_counted_by_hand():
    """Each layer has 4 voxels, with one edge straight down and two sideways each."""
    task = support_scene("ball", 2)
    assert (task.voxels == Voxel.FREE).all()
    assert count_graph(task) == (3 * 4, 2 * 4 * 3)


def test_an_unknown_scene_is_rejected_with_a_list_of_the_known_ones():
    with pytest.raises(InputError, match="ball, two-balls, plate, got 'voxel'"):
        support_scene("voxel", 10)
