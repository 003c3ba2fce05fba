"""Capacities that follow from the load: overhang on one edge, less of it the taller the support is."""

import numpy as np
import pytest

from amprep.geometry.voxels.grid import Grid
from amprep.supports.rules import PlanningRules

GRID = Grid(np.zeros(3), pitch=2.0, step=2.0, shape=(100, 10, 10))


def limit(top, **load):
    return PlanningRules(**load).edge_limit(GRID, top)


def test_without_a_load_the_capacity_asked_for_holds():
    assert limit(50) == 0
    assert limit(50, edge_capacity=3) == 3


@pytest.mark.parametrize(("area", "paths"), [(40.0, 10), (39.0, 9), (4.0, 1), (0.5, 1)])
def test_a_path_carries_one_square_of_overhang_and_one_path_always_fits(area, paths):
    assert limit(50, load_area_mm2=area) == paths


def test_a_load_beyond_all_paths_is_a_capacity_that_routers_can_count():
    assert limit(50, load_area_mm2=1e300) == 1_000_000


def test_the_smaller_of_load_and_capacity_holds():
    assert limit(50, load_area_mm2=40.0, edge_capacity=3) == 3
    assert limit(50, load_area_mm2=40.0, edge_capacity=30) == 10


def test_twice_the_height_carries_a_quarter():
    # 20 planes of 2 mm are 40 mm
    assert limit(20, load_area_mm2=160.0, load_height_mm=40.0) == 40
    assert limit(40, load_area_mm2=160.0, load_height_mm=40.0) == 10
    assert limit(10, load_area_mm2=160.0, load_height_mm=40.0) == 40
