"""Paths that are ripped up and restored leave the flow as it was, and a flow is the sum of the paths it consists of."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.kernels.flow.paths import decompose, restore, rip_up
from amprep.kernels.flow.records import Flow, FlowNetwork
from amprep.kernels.flow.shortest_paths import Paths, RoutingState
from amprep.model.supports import DIRECTIONS

PLANES, SIDE = 5, 11
WIDTH = SIDE + 2
STRIDE = WIDTH * WIDTH
SQUARES = PLANES * STRIDE


def network():
    offset = np.array([dy * WIDTH + dx for dy, dx in DIRECTIONS], np.int64)
    box = np.tile(np.array([1, SIDE, 1, SIDE], np.int64), (PLANES, 1))
    return FlowNetwork(np.ones(SQUARES, np.uint8), offset, box, STRIDE, WIDTH)


def empty_state():
    flow = Flow(np.zeros((SQUARES, 5), np.uint16), np.zeros(SQUARES, np.uint16))
    return RoutingState(
        flow,
        np.zeros(SQUARES, np.uint8),
        np.zeros(PLANES * WIDTH, np.uint8),
        np.zeros(SQUARES, np.float32),
        np.full(SQUARES, -1, np.int32),
        np.zeros(2, np.int64),
    )


def random_paths(rng, count):
    """Return unrouted paths that begin in the top plane and keep away from the border."""
    steps = PLANES - 1
    start = (PLANES - 1) * STRIDE + rng.integers(5, 8, count) * WIDTH + rng.integers(5, 8, count)
    direction = rng.integers(0, 5, count * steps).astype(np.uint8)
    return Paths(start, np.arange(count + 1) * steps, direction, np.zeros(count, np.uint8))


def flow_of(paths, chosen):
    """Add up the chosen paths edge by edge."""
    edge, square = np.zeros((SQUARES, 5), int), np.zeros(SQUARES, int)
    for r in chosen:
        u = paths.start[r]
        for d in paths.direction[paths.first[r] : paths.first[r + 1]]:
            square[u] += 1
            edge[u, d] += 1
            u += DIRECTIONS[d][0] * WIDTH + DIRECTIONS[d][1] - STRIDE
        square[u] += 1
    return edge.tolist(), square.tolist()


@examples(40)
@given(st.integers(0, 10**6), st.integers(1, 8))
def test_the_flow_is_the_sum_of_the_paths_that_are_routed(seed, count):
    rng = np.random.default_rng(seed)
    paths, state, everyone = random_paths(rng, count), empty_state(), np.arange(count)
    restore(network(), state, paths, everyone)
    ripped = np.flatnonzero(rng.random(count) < 0.5)
    for _ in range(2):  # the second call changes nothing
        rip_up(network(), state, paths, ripped)
        left = np.setdiff1d(everyone, ripped)
        assert (state.flow.edge.tolist(), state.flow.square.tolist()) == flow_of(paths, left)
    used = state.flow.edge > 0
    assert state.edges_used.tolist() == [used[:, 0].sum(), used[:, 1:].sum()]
    restore(network(), state, paths, ripped)
    assert (state.flow.edge.tolist(), state.flow.square.tolist()) == flow_of(paths, everyone)


@examples(40)
@given(st.integers(0, 10**6), st.integers(1, 8))
def test_a_flow_is_decomposed_into_paths_that_add_up_to_it(seed, count):
    paths, state = random_paths(np.random.default_rng(seed), count), empty_state()
    restore(network(), state, paths, np.arange(count))
    expected = flow_of(paths, range(count))
    paths.direction[:] = 9
    decompose(network(), state.flow, paths)
    assert (state.flow.edge.tolist(), state.flow.square.tolist()) == expected
    assert flow_of(paths, range(count)) == expected
