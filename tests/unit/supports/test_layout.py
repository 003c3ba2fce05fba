"""Support groups are the connected components of the supports, joined where they belong to the same part."""

import networkx as nx
import numpy as np
import pytest

from amprep.model import DIRECTIONS, SupportEdges
from amprep.supports.grid.red_squares import RedSquares
from amprep.supports.layout import groups_of


def random_supports(seed):
    """Columns with random steps, each from a red square of a random part down to the plate."""
    rng = np.random.default_rng(seed)
    squares, parts, rows = [], [], []
    for _ in range(8):
        plane, (y, x), part = int(rng.integers(0, 5)), rng.integers(2, 9, 2).tolist(), int(rng.integers(0, 4))
        squares.append((plane, y, x))
        parts.append(part)
        for level in range(plane, 0, -1):
            direction = int(rng.integers(0, 5))
            rows.append((level, y, x, direction, 1, 1, part))
            y, x = y + DIRECTIONS[direction][0], x + DIRECTIONS[direction][1]
    nothing = np.zeros(len(parts), np.int32)
    red = RedSquares(np.array(squares, np.int32), np.array(parts, np.int32), nothing, nothing)
    return SupportEdges.from_rows(rows), red, rng.random(len(parts)) < 0.8


@pytest.mark.parametrize("seed", range(8))
def test_groups_are_the_components_of_squares_and_parts_in_networkx(seed):
    edges, red, connected = random_supports(seed)
    kept = [
        tuple(int(n) for n in square)
        for square, is_kept in zip(red.square, connected, strict=True)
        if is_kept
    ]
    graph = nx.Graph()
    graph.add_edges_from(zip(map(tuple, edges.upper.tolist()), map(tuple, edges.lower.tolist()), strict=True))
    graph.add_nodes_from(kept)
    graph.add_edges_from((square, int(part)) for square, part in zip(kept, red.part[connected], strict=True))
    components = [part for part in nx.connected_components(graph) if any(isinstance(n, int) for n in part)]
    red_group, _, group_parts = groups_of(edges, red, connected, 4)
    assert (red_group[~connected] == -1).all()
    assert {frozenset(parts) for parts in group_parts} == {
        frozenset(node for node in component if isinstance(node, int)) for component in components
    }
    for square, part, group in zip(kept, red.part[connected], red_group[connected], strict=True):
        assert int(part) in group_parts[group], square
