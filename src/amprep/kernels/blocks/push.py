"""Boxes pushed along an axis, compiled, until they meet a wall, an obstacle or one another."""

from numba import njit


@njit(cache=True, nogil=True)
def push(boxes, order, obstacles, axis):
    """Push boxes ``(n, 6)`` (in place) towards 0 along an axis, in an order of rising position.

    Returns
    -------
    int
        How many moved.
    """
    b, c = (axis + 1) % 3, (axis + 2) % 3
    moved = 0
    for place in range(order.size):
        i, lowest = order[place], 0
        for k in range(place + obstacles.shape[0]):
            other = boxes[order[k]] if k < place else obstacles[k - place]
            beside = other[b] >= boxes[i, 3 + b] or other[3 + b] <= boxes[i, b]
            beside = beside or other[c] >= boxes[i, 3 + c] or other[3 + c] <= boxes[i, c]
            if not beside and other[3 + axis] <= boxes[i, axis]:
                lowest = max(lowest, other[3 + axis])
        if lowest < boxes[i, axis]:
            boxes[i, 3 + axis] -= boxes[i, axis] - lowest
            boxes[i, axis] = lowest
            moved += 1
    return moved
