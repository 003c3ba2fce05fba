"""Kernel for minimum cuts: sends on what still finds a way, and lists what the rest can come to."""

from numba import njit

from amprep.arrays import Bytes, Int32s, Int64s
from amprep.kernels.flow.residual import Carried, Room, shift
from amprep.kernels.flow.shortest_paths import Network
from amprep.kernels.helper import helper

UNSEEN, OPEN, CLOSED = 0, 1, 2
"""A state that no search has come to; that is on a way that was found; that a search has left in vain."""


@helper
def _end(network: Network, carried: Carried, room: Room, s: int, k: int) -> int:
    """Return the state that arc k of state s leads to, or -1 when it takes no further unit."""
    u, stride, offset = s >> 1, network.stride, network.offset
    if s & 1:
        if k == 5:
            return s - 1 if carried.through[u] > 0 else -1
        v = u - stride + offset[k]
        free = network.via[v] and carried.flow[u, k] < room.edge[(5 * u + k) * room.each]
        return 2 * v if free else -1
    if k == 0:
        return s + 1 if u >= stride and carried.through[u] < room.square[u * room.each] else -1
    direction = k if k < 5 else 0
    w = u + stride - offset[direction]
    return 2 * w + 1 if w < network.via.size and carried.flow[w, direction] > 0 else -1


@njit(cache=True)
def extend(
    network: Network,
    carried: Carried,
    room: Room,
    ground: Int32s,
    starts: Int64s,
    served: Bytes,
    seen: Bytes,
    stack: Int32s,
    arcs: Bytes,
    reached: Int32s,
) -> int:
    """Send a unit to the plate from each of `starts` that finds a way, depth first; list what was looked at.

    A state that one search has left stays closed to those that follow, unless it is on a way that was found. So
    nothing is overlooked for good only when nobody is served: then the states listed are all that can be
    reached, and the arcs that lead out of them are a minimum cut.

    Parameters
    ----------
    ground
        ``(stride,)`` how many more paths may end at each square of the plate; modified in place.
    served
        Set to 1 for the starts that are served; these are passed over.
    seen
        ``(states,)`` uint8, 0 at first and afterwards.
    stack, arcs
        ``(states,)`` work arrays.
    reached
        ``(states,)``, its first entries are set; their number is returned.
    """
    count = 0
    for i in range(starts.size):
        first = 2 * starts[i]
        if served[i] or seen[first] == CLOSED:
            continue
        length, stack[0], arcs[0] = 0, first, 0
        if seen[first] == UNSEEN:
            reached[count] = first
            count += 1
        seen[first] = CLOSED
        while length >= 0 and (stack[length] >= 2 * network.stride or ground[stack[length] >> 1] == 0):
            to = -1
            while arcs[length] < 6 and to < 0:
                to = _end(network, carried, room, stack[length], arcs[length])
                to = -1 if to >= 0 and seen[to] == CLOSED else to
                arcs[length] += to < 0
            if to < 0:
                length -= 1
                continue
            length += 1
            stack[length], arcs[length] = to, 0
            if seen[to] == UNSEEN:
                reached[count] = to
                count += 1
            seen[to] = CLOSED
        served[i] = length >= 0
        if served[i]:
            ground[stack[length] >> 1] -= 1
        for j in range(length):
            shift(network, carried, stack[j], arcs[j], 1)
        for j in range(length + 1):
            seen[stack[j]] = OPEN
    for i in range(count):
        seen[reached[i]] = UNSEEN
    return count
