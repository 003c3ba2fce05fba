"""The greatest depth is that of all points and planes."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from amprep.kernels.bounding.depth import greatest_depth


@pytest.mark.parametrize("seed", range(5))
def test_the_depth_is_the_greatest_of_the_least_distances(seed):
    points = np.random.default_rng(seed).normal(size=(60, 3))
    equations = ConvexHull(points).equations
    planes = np.column_stack((equations[:, :3], -equations[:, 3]))
    expected = (planes[:, 3] - points @ planes[:, :3].T).min(axis=1).max()
    assert greatest_depth(points, planes) == pytest.approx(expected)


def test_points_on_the_surface_have_no_depth():
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    planes = np.column_stack((np.vstack((np.eye(3), -np.eye(3))), [1, 1, 1, 0, 0, 0.0]))
    assert greatest_depth(cube, planes) == 0.0
