"""The pricing kernel: the greatest value of a set of boxes, against trying every set."""

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.kernels.boxes import pricing
from amprep.kernels.boxes.relations import IMPOSSIBLE, fit_together, relation_scratch

ROOM = np.full(3, 10.0)


def state_for(types, most, scales):
    return pricing.PricingState(
        memory=pricing.Memory(np.zeros(1 << 10, np.uint64), np.zeros(1 << 10, np.uint8)),
        chosen=np.zeros(most + 1, np.int64),
        keys=np.zeros(most + 2, np.uint64),
        held=np.zeros(types, np.int64),
        blocked=np.zeros(types, np.int64),
        left=np.ones(scales),
        sizes=np.zeros((12, 3)),
        relations=relation_scratch(12),
        outcome=np.zeros(4),
    )


def price_of(size, profit, demand):
    """The result code, the greatest value, and the last sets found."""
    load = (size / ROOM).prod(axis=1)[:, None]
    conflict = ((size[:, None] + size[None]) > ROOM).all(axis=2)
    code = np.random.default_rng(0).integers(1, 2**63, len(size), dtype=np.uint64)
    sets = pricing.Sets(demand, size, ROOM, load, conflict, code)
    order = np.argsort(-profit / load[:, 0], kind="stable")
    rank = np.empty(len(size), np.int64)
    rank[order] = np.arange(len(size))
    state, columns = state_for(len(size), int(demand.sum()), 1), np.zeros((10, len(size)), np.int64)
    limits = pricing.PricingLimits(1e9, 1e9, 12, 100_000)
    result = pricing.price(profit, np.vstack((rank, order)), limits, sets, state, columns)
    found = int(state.outcome[pricing.FOUND])
    return result, float(state.outcome[pricing.VALUE]), columns[: min(found, 10)]


def fits(sizes):
    verdict, _ = fit_together(len(sizes), np.array(sizes), ROOM, 100_000, relation_scratch(12))
    return verdict != IMPOSSIBLE


@examples(40)
@given(
    st.lists(st.tuples(*[st.integers(2, 9)] * 3), min_size=1, max_size=4),
    st.data(),
)
def test_the_greatest_value_is_that_of_the_best_set_that_fits(sizes, data):
    size = np.array(sizes, float)
    demand = np.array([data.draw(st.integers(1, 2)) for _ in sizes])
    profit = np.array([data.draw(st.integers(1, 8)) / 4.0 for _ in sizes])
    best = 1.0
    for counts in itertools.product(*(range(d + 1) for d in demand)):
        chosen = [size[k] for k, n in enumerate(counts) for _ in range(n)]
        if chosen and float(np.dot(counts, profit)) > best and fits(chosen):
            best = float(np.dot(counts, profit))
    code, value, columns = price_of(size, profit, demand)
    assert code == pricing.EXACT
    assert abs(value - best) < 1e-6
    for column in columns:
        assert (column <= demand).all()
        assert fits([size[k] for k, n in enumerate(column) for _ in range(n)])


def test_without_a_set_of_value_above_one_nothing_is_found():
    code, value, columns = price_of(
        np.array([[9.0, 9, 9], [8, 8, 8]]), np.array([0.5, 1.0]), np.array([2, 2])
    )
    assert code == pricing.EXACT
    assert abs(value - 1.0) < 1e-6
    assert len(columns) == 0
