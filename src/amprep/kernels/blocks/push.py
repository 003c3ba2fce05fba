"""Push boxes along an axis until each meets a wall, an obstacle or another box."""

from numba import njit

from amprep.arrays import Int64s


@njit(cache=True, nogil=True)
def push(boxes: Int64s, order: Int64s, obstacles: Int64s, axis: int) -> int:
    """Push boxes towards 0 along an axis and return the number of boxes that moved.

    Each box moves to the highest upper face among the boxes and obstacles below it, so boxes pushed earlier
    are already in their final position. The running time is quadratic in the number of boxes.

    Parameters
    ----------
    boxes
        ``(n, 6)`` corners; modified in place.
    order
        ``(n,)`` the boxes by increasing position along the axis.
    obstacles
        ``(m, 6)`` corners of boxes that do not move.
    axis
        0, 1 or 2.
    """
    b, c = (axis + 1) % 3, (axis + 2) % 3
    moved = 0
    for rank in range(order.size):
        i, lowest = order[rank], 0
        for k in range(rank + obstacles.shape[0]):
            other = boxes[order[k]] if k < rank else obstacles[k - rank]
            beside = other[b] >= boxes[i, 3 + b] or other[3 + b] <= boxes[i, b]
            beside = beside or other[c] >= boxes[i, 3 + c] or other[3 + c] <= boxes[i, c]
            if not beside and other[3 + axis] <= boxes[i, axis]:
                lowest = max(lowest, other[3 + axis])
        if lowest < boxes[i, axis]:
            boxes[i, 3 + axis] -= boxes[i, axis] - lowest
            boxes[i, axis] = lowest
            moved += 1
    return moved
