"""The heap of edges gives the order of sorting, under inserts, changes and removals."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numba import njit
from tests.shared.examples import examples

from amprep.kernels.bounding.simplification.edge_heap import EdgeHeap, remove, update

COUNT = 30


@njit
def _update(heap, edge, key):
    update(heap, edge, key)


@njit
def _remove(heap, edge):
    remove(heap, edge)


def empty():
    return EdgeHeap(
        np.zeros(COUNT), np.full(COUNT, -1, np.int32), np.empty(COUNT, np.int32), np.zeros(1, np.int32)
    )


@given(st.lists(st.tuples(st.integers(0, COUNT - 1), st.integers(-1, 5)), max_size=80))
@examples(60)
def test_edges_leave_the_heap_by_cost_and_number(changes):
    heap = empty()
    costs: dict[int, int] = {}
    for edge, cost in changes:
        if cost < 0:
            _remove(heap, edge)
            costs.pop(edge, None)
        else:
            _update(heap, edge, float(cost))
            costs[edge] = cost
    order = []
    while heap.size[0]:
        order.append(int(heap.heap[0]))
        _remove(heap, order[-1])
    assert order == sorted(costs, key=lambda edge: (costs[edge], edge))


def test_an_edge_of_infinite_cost_is_removed():
    heap = empty()
    _update(heap, 3, 1.0)
    _update(heap, 3, np.inf)
    assert heap.size[0] == 0
