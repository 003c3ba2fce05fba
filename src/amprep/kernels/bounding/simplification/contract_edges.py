"""The main loop: contract the cheapest edge until a target is met."""

from typing import NamedTuple

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.bounding.simplification.box_tree import MovingBoxTree, refit
from amprep.kernels.bounding.simplification.collisions import collides
from amprep.kernels.bounding.simplification.edge_heap import EdgeHeap, remove, update
from amprep.kernels.bounding.simplification.error_bound import OriginalSurface, exceeds
from amprep.kernels.bounding.simplification.half_edges import (
    HalfEdgeSurface,
    contract,
    edge_of,
    following,
    rotated,
)
from amprep.kernels.bounding.simplification.patches import EdgePatch, gather
from amprep.kernels.bounding.simplification.placement import REFUSED, ContractionRules, place_vertex
from amprep.kernels.bounding.simplification.points import kernel, part


class ContractionState(NamedTuple):
    """What finds and checks contractions; arrays are modified in place.

    Attributes
    ----------
    heap, tree, patch
        Edges by cost, boxes of the triangles, work arrays of one contraction.
    original
        The surface from which the distance is bounded.
    found, stamp, box
        Work arrays of `collides`.
    """

    heap: EdgeHeap
    tree: MovingBoxTree
    patch: EdgePatch
    original: OriginalSurface
    found: Int32s
    stamp: Int64s
    box: Floats


@part
def _evaluate(
    surface: HalfEdgeSurface, state: ContractionState, rules: ContractionRules, h: int
) -> tuple[float, int]:
    """Return the cost of contracting an edge and the number of triangles around it."""
    count = gather(surface, state.patch, h)
    if count == 0:
        return REFUSED, 0
    return place_vertex(surface, state.patch, count, rules, h), count


@kernel
def fill_heap(surface: HalfEdgeSurface, state: ContractionState, rules: ContractionRules) -> None:
    """Evaluate all edges that are left."""
    for h in range(surface.start.size):
        if surface.start[h] >= 0 and h < surface.opposite[h]:
            update(state.heap, h, _evaluate(surface, state, rules, h)[0])


@part
def _forget_edges(surface: HalfEdgeSurface, state: ContractionState, count: int) -> None:
    """Remove the edges of the triangles around an edge from the heap, because their numbers will change."""
    for i in range(count):
        first = 3 * state.patch.triangles[i]
        for h in range(first, first + 3):
            remove(state.heap, edge_of(surface, h))


@part
def _renew_edges(
    surface: HalfEdgeSurface, state: ContractionState, rules: ContractionRules, vertex: int
) -> None:
    """Evaluate the edges of the triangles around a vertex."""
    first = surface.leaving[vertex]
    h = first
    while True:
        for k in range(2):
            g = h if k == 0 else following(h)
            update(state.heap, edge_of(surface, g), _evaluate(surface, state, rules, g)[0])
        h = rotated(surface, h)
        if h == first:
            break


@kernel
def contract_edges(
    surface: HalfEdgeSurface, state: ContractionState, rules: ContractionRules, triangles: int, most: int
) -> int:
    """Contract up to `most` edges, cheapest first, while more than a target of triangles is left.

    Costs of edges further away may be out of date: the cheapest edge is evaluated again, and goes back if it now
    costs more.

    Parameters
    ----------
    triangles
        How many triangles should go.
    most
        Largest number of contractions.

    Returns
    -------
    Number of contractions; fewer than asked for if no edge is left.
    """
    heap, patch = state.heap, state.patch
    done = 0
    while done < most and 2 * done < triangles and heap.size[0] > 0:
        edge = heap.heap[0]
        cost, count = _evaluate(surface, state, rules, edge)
        if cost > heap.key[edge] * (1.0 + 1e-9) + 1e-12:
            update(heap, edge, cost)
            continue
        if collides(surface, patch, state.tree, state.found, state.stamp, state.box, count) or exceeds(
            state.original, surface, patch, count
        ):
            remove(heap, edge)
            continue
        _forget_edges(surface, state, count)
        vertex = contract(surface, edge, (patch.place[0], patch.place[1], patch.place[2]))
        for i in range(count):
            refit(state.tree, surface, patch.triangles[i])
        _renew_edges(surface, state, rules, vertex)
        done += 1
    return done
