"""Distances in the layered network agree with networkx; arcs of the residual network lead back to where they start."""

import networkx as nx
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.kernels import plain

from amprep.kernels.flow.records import UNREACHABLE, FlowNetwork
from amprep.kernels.flow.residual import ARCS, find_distances, head_of, is_backward, reverse_of
from amprep.model.supports import DIRECTIONS


def network_of(passable):
    """Return the network of squares ``(planes, ny, nx)``, padded by one square on each side."""
    planes, ny, nx_ = passable.shape
    padded = np.zeros((planes, ny + 2, nx_ + 2), np.uint8)
    padded[:, 1:-1, 1:-1] = passable
    width = nx_ + 2
    offset = np.array([dy * width + dx for dy, dx in DIRECTIONS], np.int64)
    box = np.tile(np.array([1, ny, 1, nx_], np.int64), (planes, 1))
    return FlowNetwork(padded.ravel(), offset, box, (ny + 2) * width, width)


@examples(40)
@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(1, 5))
def test_distances_to_the_plate_are_those_of_networkx(seed, vertical, oblique):
    rng = np.random.default_rng(seed)
    network = network_of(rng.random(tuple(rng.integers(1, 6, 3))) < 0.6)
    graph = nx.DiGraph()
    graph.add_node("plate")
    for u in np.flatnonzero(network.passable).tolist():
        if u < network.stride:
            graph.add_edge("plate", u, cost=0)
            continue
        for d, offset in enumerate(network.offset.tolist()):
            below = u - network.stride + offset
            if network.passable[below]:
                graph.add_edge(below, u, cost=oblique if d else vertical)
    expected = nx.single_source_dijkstra_path_length(graph, "plate", weight="cost")
    inner = [u for u in range(network.passable.size) if _is_inner(network, u)]
    distance = np.full(network.passable.size, UNREACHABLE, np.int32)
    find_distances(network, vertical, oblique, distance)
    assert [distance[u] for u in inner] == [expected.get(u, UNREACHABLE) for u in inner]
    reached = [u for u in inner if u in expected]
    assert np.flatnonzero(network.passable).tolist() == reached, "the others are impassable afterwards"


def _is_inner(network, u):
    y, x = divmod(u % network.stride, network.width)
    return 1 <= x < network.width - 1 and 1 <= y < network.stride // network.width - 1


def test_the_reverse_of_an_arc_leads_back_and_undoes_it():
    network = network_of(np.ones((3, 3, 3), bool))
    middle = network.stride + 2 * network.width + 2
    for state in (2 * middle, 2 * middle + 1):
        for arc in range(ARCS):
            head, back = plain(head_of)(network, state, arc), plain(reverse_of)(arc)
            assert plain(head_of)(network, head, back) == state
            assert plain(is_backward)(state, arc) != plain(is_backward)(head, back)
