"""Work arrays of the queries on OBB trees."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from amprep.kernels.trees.records import Stack


def new_stack(depth: int, other_depth: int) -> "Stack":
    """Return work arrays for queries on trees of at most these depths.

    Each step of a traversal goes one level deeper in one tree and keeps at most one other pair.
    """
    from amprep.kernels.trees.records import Stack

    size = depth + other_depth + 4
    return Stack(np.empty((size, 2), np.int32), np.empty(size), np.empty(18))
