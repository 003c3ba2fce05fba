"""Edges of a support network: merging, selection and components, compared with plain Python and networkx."""

from collections import defaultdict

import networkx as nx
import numpy as np
import pytest

from amprep.model import DIRECTIONS, SupportEdges


def random_edges(seed, count=60):
    rng = np.random.default_rng(seed)
    rows = np.column_stack(
        [rng.integers(1, 4, (count, 3)), rng.integers(0, 5, count), rng.integers(1, 9, (count, 3))]
    )
    return SupportEdges.from_rows(rows.tolist()), rows.tolist()


def test_routers_leave_part_and_group_open():
    edges = SupportEdges([2, 1], [0, 0], [0, 1], [1, 0], [1, 1], [1, 1])
    assert (edges.part.tolist(), edges.group.tolist()) == ([0, 0], [-1, -1])
    assert edges.upper.tolist() == [[2, 0, 0], [1, 0, 1]]
    assert edges.lower.tolist() == [[1, 0, 1], [0, 0, 1]]
    assert edges.voxels.tolist() == [[1, 0, 0], [1, 0, 1], [0, 0, 1], [0, 0, 1]]


@pytest.mark.parametrize("count", [0, 60])
def test_rows_are_those_that_edges_were_made_from(count):
    edges, rows = random_edges(0, count)
    assert edges.rows() == rows


def test_arrays_of_different_length_are_refused():
    with pytest.raises(ValueError, match="equally long"):
        SupportEdges([2, 1], [0, 0], [0, 1], [1, 0], [1], [1, 1])


@pytest.mark.parametrize("seed", range(5))
def test_merged_edges_have_the_sum_of_flows_the_largest_capacity_and_the_first_part(seed):
    edges, rows = random_edges(seed)
    same = defaultdict(list)
    for *edge, flow, capacity, part in rows:
        same[tuple(edge)].append((flow, capacity, part))
    expected = [
        (
            *edge,
            sum(flow for flow, _, _ in each),
            max(sum(f for f, _, _ in each), *(c for _, c, _ in each)),
            each[0][2],
        )
        for edge, each in sorted(same.items())
    ]
    assert list(zip(*(column.tolist() for column in edges.merged().columns[:7]), strict=True)) == expected


@pytest.mark.parametrize("seed", range(5))
def test_components_are_those_of_networkx(seed):
    edges, rows = random_edges(seed, 12)
    squares = np.array([(3, 3, 3), (1, 2, 2), (9, 9, 9)], np.int32)
    graph = nx.Graph()
    graph.add_nodes_from(map(tuple, squares.tolist()))
    for plane, y, x, direction, *_ in rows:
        dy, dx = DIRECTIONS[direction]
        graph.add_edge((plane, y, x), (plane - 1, y + dy, x + dx))
    of_edge, of_square = edges.components(squares)
    ends = [tuple(row[:3]) for row in rows] + [tuple(square) for square in squares.tolist()]
    labels = np.concatenate([of_edge, of_square])
    for i, one in enumerate(ends):
        for j, other in enumerate(ends):
            assert (labels[i] == labels[j]) == nx.has_path(graph, one, other)


def test_blocks_are_concatenated_in_order_and_masks_select_edges():
    one, two = random_edges(0)[0], random_edges(1)[0]
    both = SupportEdges.concatenate([one, two])
    assert (both.upper == np.concatenate([one.upper, two.upper])).all()
    assert both[both.part == 3].part.tolist() == [3] * int((both.part == 3).sum())
    assert len(SupportEdges.concatenate([])) == 0
