"""Cheapest paths down through blocks of voxels, beside shortest paths by networkx."""

import networkx as nx
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.supports import paths
from amprep.model.supports import edges

END = "end"


def test_the_directions_are_those_of_support_edges():
    assert paths.DIRECTIONS == edges.DIRECTIONS


@given(seed=st.integers(0, 2**32), anywhere=st.booleans())
@examples(60)
def test_a_path_is_as_cheap_as_the_shortest_one_of_networkx(seed, anywhere):
    rng = np.random.default_rng(seed)
    free = rng.random(tuple(rng.integers(1, 6, 3))) < 0.8
    prices = paths.edge_prices(free, 1.0, 2.0)
    start, goal = (tuple(int(rng.integers(0, n)) for n in free.shape[1:]) for _ in range(2))
    graph = nx.DiGraph()
    graph.add_node((len(free), *start))
    for k, y, x in np.ndindex(*free.shape):
        for direction, (dy, dx) in enumerate(paths.DIRECTIONS):
            if np.isfinite(price := prices[k, direction, y, x]):
                graph.add_edge((k + 1, y, x), (k, y + dy, x + dx), weight=price)
    ends = [node for node in graph if node[0] == 0 and (anywhere or node[1:] == goal)]
    graph.add_edges_from(((node, END) for node in ends), weight=0.0)
    graph.add_node(END)
    found = paths.cheapest_path(prices, start, None if anywhere else goal)
    if not nx.has_path(graph, (len(free), *start), END):
        assert found is None
        return
    y, x = start
    cost = 0.0
    for layer, direction in zip(range(len(free) - 1, -1, -1), found, strict=True):
        cost += prices[layer, direction, y, x]
        y, x = y + paths.DIRECTIONS[direction][0], x + paths.DIRECTIONS[direction][1]
    assert np.isclose(cost, nx.shortest_path_length(graph, (len(free), *start), END, weight="weight"))
    assert anywhere or (y, x) == goal


def test_of_equal_paths_the_one_that_goes_sideways_lowest_is_cheapest():
    prices = paths.edge_prices(np.ones((5, 1, 3), np.bool_), 1.0, 2.0)
    assert paths.cheapest_path(prices, (0, 0), (0, 2)) == [0, 0, 0, 1, 1]
