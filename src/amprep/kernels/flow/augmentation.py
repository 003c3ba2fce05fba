"""Kernel for augmentation: depth-first searches for paths to the plate, and the states that they reach.

Strategy: a few units are missing from a maximum flow, because the network is congested or capacities have
grown. Each start searches the residual network depth first and sends a unit along the first path to the plate.
A state that a search leaves without success stays closed to the searches after it, so all searches together
look at each arc once. A later augmentation can open such a state again, so a path may be overlooked; but if
no start is served, the states listed are exactly those that can be reached, and the arcs that lead out of them
form a minimum cut (Ford and Fulkerson 1962).
"""

from typing import NamedTuple

from amprep.arrays import Bytes, Int32s, Int64s
from amprep.kernels.flow.records import ResidualNetwork
from amprep.kernels.flow.residual import ARCS, head_of, residual_capacity, send
from amprep.kernels.helper import inlined, kernel

UNSEEN, ON_PATH, CLOSED = 0, 1, 2
"""Marks of states: not yet seen; on a path that was found; left without success, or on the path being searched."""


class DepthFirstArrays(NamedTuple):
    """Work arrays over all states.

    Attributes
    ----------
    seen
        ``(states,)`` uint8, marks; all 0 before and after a call.
    stack, arcs
        ``(states,)`` the path that is being searched: its states, and the arc that it takes from each.
    reached
        ``(states,)`` int32, list of the states that were seen.
    """

    seen: Bytes
    stack: Int32s
    arcs: Bytes
    reached: Int32s


@inlined
def _see(work: DepthFirstArrays, state: int, length: int, count: int) -> int:
    """Put a state at the end of the path and mark it; return the number of states reached."""
    work.stack[length], work.arcs[length] = state, 0
    if work.seen[state] == UNSEEN:
        work.reached[count] = state
        count += 1
    work.seen[state] = CLOSED
    return count


@inlined
def _next_arc(residual: ResidualNetwork, seen: Bytes, state: int, first: int) -> int:
    """Return the first residual arc from `first` of a state to a state that is not closed, or `ARCS`."""
    for k in range(first, ARCS):
        head = head_of(residual.network, state, k)
        if head >= 0 and seen[head] != CLOSED and residual_capacity(residual, state, k, head) > 0:
            return k
    return ARCS


@inlined
def _find_path(
    residual: ResidualNetwork, plate_capacity: Int32s, start: int, work: DepthFirstArrays, count: int
) -> tuple[int, int]:
    """Search a path to the plate; return its number of arcs (-1: none) and the number of states reached."""
    plate, stack, arcs, length = 2 * residual.network.stride, work.stack, work.arcs, 0
    count = _see(work, start, 0, count)
    while length >= 0 and (stack[length] >= plate or plate_capacity[stack[length] >> 1] == 0):
        s, k = stack[length], arcs[length]
        # each of the two inlined copies has only the arcs of its kind of state
        k = _next_arc(residual, work.seen, s | 1, k) if s & 1 else _next_arc(residual, work.seen, s & ~1, k)
        arcs[length] = k
        if k == ARCS:
            length -= 1
        else:
            length += 1
            count = _see(work, head_of(residual.network, s, k), length, count)
    return length, count


@kernel
def augment_depth_first(
    residual: ResidualNetwork, plate_capacity: Int32s, starts: Int64s, served: Bytes, work: DepthFirstArrays
) -> int:
    """Send a unit to the plate from each of `starts` for which a path is found; list the states reached.

    Parameters
    ----------
    plate_capacity
        ``(stride,)`` number of further paths that may end at each square of the plate; modified in place.
    starts
        ``(n,)`` squares.
    served
        ``(n,)`` uint8, set to 1 for the starts that are served; starts with a 1 are passed over.

    Returns
    -------
    int
        Number of entries of ``work.reached`` that have been written.
    """
    seen, stack, arcs, count = work.seen, work.stack, work.arcs, 0
    for i in range(starts.size):
        if served[i] or seen[2 * starts[i]] == CLOSED:
            continue
        length, count = _find_path(residual, plate_capacity, 2 * starts[i], work, count)
        if length >= 0:
            served[i] = 1
            plate_capacity[stack[length] >> 1] -= 1
        for j in range(length):
            send(residual, stack[j], arcs[j], stack[j + 1], 1)
        for j in range(length + 1):
            seen[stack[j]] = ON_PATH
    for i in range(count):
        seen[work.reached[i]] = UNSEEN
    return count
