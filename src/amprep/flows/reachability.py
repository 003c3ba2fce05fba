"""Which red squares can reach the plate."""

import numpy as np

from amprep.arrays import Bools
from amprep.model.supports import (
    SupportProblem,
    Voxel,
)


def has_way(problem: SupportProblem) -> Bools:
    """Tell which red squares have any white way to the plate: one sweep up, independent of all routers."""
    top = int(problem.red[:, 0].max(initial=0))
    reached = problem.green.copy()
    way = np.zeros(len(problem.red), np.bool_)
    for plane in range(1, top + 1):
        white = problem.voxels[plane - 1] == Voxel.FREE
        below = reached & white
        reached = below.copy()
        reached[1:] |= below[:-1]
        reached[:-1] |= below[1:]
        reached[:, 1:] |= below[:, :-1]
        reached[:, :-1] |= below[:, 1:]
        reached &= white
        here = problem.red[:, 0] == plane
        way[here] = reached[problem.red[here, 1], problem.red[here, 2]]
    return way
