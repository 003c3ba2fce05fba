"""A heap of edges by their cost, in which each edge has at most one entry."""

from typing import NamedTuple

from amprep.arrays import Floats, Int32s
from amprep.kernels.bounding.simplification.points import inlined, part


class EdgeHeap(NamedTuple):
    """A binary heap; arrays are modified in place.

    Attributes
    ----------
    key
        ``(e,)`` cost of each edge.
    place
        ``(e,)`` place of each edge in `heap`; -1 for an edge that is not there.
    heap
        ``(e,)`` edges, of which the first `size` are used; both children of place i cost at least as much.
    size
        ``(1,)`` number of entries.
    """

    key: Floats
    place: Int32s
    heap: Int32s
    size: Int32s


@inlined
def _before(heap: EdgeHeap, one: int, other: int) -> bool:
    """Compare two edges by cost; of equal ones, the lower number comes first."""
    return bool(heap.key[one] < heap.key[other] or (heap.key[one] == heap.key[other] and one < other))


@part
def _rise(heap: EdgeHeap, i: int) -> int:
    edge = heap.heap[i]
    while i > 0:
        above = (i - 1) >> 1
        other = heap.heap[above]
        if not _before(heap, edge, other):
            break
        heap.heap[i] = other
        heap.place[other] = i
        i = above
    heap.heap[i] = edge
    heap.place[edge] = i
    return i


@part
def _sink(heap: EdgeHeap, i: int) -> None:
    edge, size = heap.heap[i], heap.size[0]
    while 2 * i + 1 < size:
        below = 2 * i + 1
        if below + 1 < size and _before(heap, heap.heap[below + 1], heap.heap[below]):
            below += 1
        other = heap.heap[below]
        if not _before(heap, other, edge):
            break
        heap.heap[i] = other
        heap.place[other] = i
        i = below
    heap.heap[i] = edge
    heap.place[edge] = i


@part
def remove(heap: EdgeHeap, edge: int) -> None:
    """Remove an edge if it is in the heap."""
    i = heap.place[edge]
    if i < 0:
        return
    heap.place[edge] = -1
    heap.size[0] -= 1
    last = heap.heap[heap.size[0]]
    if last != edge:
        heap.heap[i] = last
        heap.place[last] = i
        _sink(heap, _rise(heap, i))


@part
def update(heap: EdgeHeap, edge: int, key: float) -> None:
    """Insert an edge, or change its cost; an edge of infinite cost is removed."""
    if key >= 1e300:
        remove(heap, edge)
        return
    heap.key[edge] = key
    i = heap.place[edge]
    if i < 0:
        i = heap.size[0]
        heap.size[0] += 1
        heap.heap[i] = edge
    _sink(heap, _rise(heap, i))
