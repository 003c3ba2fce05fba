"""Kernel for minimum cuts: what paths can still reach in the residual network of a greatest flow."""

from numba import njit

from amprep.kernels.flow_network import Carried, Room
from amprep.kernels.routing import Bytes, Ints, Longs, Network


@njit(cache=True)
def reach(network: Network, carried: Carried, room: Room, starts: Longs, seen: Bytes, reached: Ints) -> int:
    """Mark and list all states that a unit could come to from `starts`; return how many there are.

    Parameters
    ----------
    seen
        ``(states,)`` uint8, 0 at first; set to 1 for what can be reached.
    reached
        ``(states,)``, its first entries are set.
    """
    flow, through, via, offset = carried.flow, carried.through, network.via, network.offset
    edge_room, square_room, each = room.edge, room.square, room.each
    stride, top, count, done = network.stride, network.via.size, 0, 0
    for u in starts:
        seen[2 * u] = 1
        reached[count] = 2 * u
        count += 1
    while done < count:
        s = reached[done]
        done += 1
        u = s >> 1
        for k in range(6):
            t = -1
            if s & 1 and k < 5:
                v = u - stride + offset[k]
                if via[v] and flow[u, k] < edge_room[(5 * u + k) * each]:
                    t = 2 * v
            elif s & 1:
                t = s - 1 if through[u] > 0 else -1
            elif k == 5:
                t = s + 1 if u >= stride and through[u] < square_room[u * each] else -1
            else:
                w = u + stride - offset[k]
                if w < top and flow[w, k] > 0:
                    t = 2 * w + 1
            if t >= 0 and not seen[t]:
                seen[t] = 1
                reached[count] = t
                count += 1
    return count
