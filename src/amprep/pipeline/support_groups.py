"""Support groups: one per part, and one of all parts whose supports meet in a square."""

import numpy as np

from amprep.model.arrays import Bools, Ints
from amprep.pipeline.support_edges import components
from amprep.pipeline.support_red import RedSquares


def groups_of(
    edges: Ints, red: RedSquares, connected: Bools, count: int
) -> tuple[Ints, Ints, tuple[tuple[int, ...], ...]]:
    """Return the group of each red square ``(m,)`` (-1: none), of each edge ``(n,)``, and the parts of each group."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, of_red = components(edges, red.square[connected])
    part = red.part[connected]
    owner = np.full(int(of_red.max(initial=-1)) + 1, -1)
    owner[of_red[::-1]] = part[::-1]
    graph = coo_array((np.ones(len(part)), (part, owner[of_red])), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    used, number = np.unique(label[part], return_inverse=True)
    group = np.full(len(red.part), -1, np.int32)
    group[connected] = number
    edge_group = np.searchsorted(used, label[edges[:, 6]]).astype(np.int32)
    held = [sorted(set(part[number == i].tolist())) for i in range(len(used))]
    return group, edge_group, tuple(tuple(each) for each in held)
