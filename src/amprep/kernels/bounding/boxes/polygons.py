"""Clip convex polygons to half-spaces and to the outside of boxes.

Polygon p has the corners ``points[corners[i]]`` for i from ``first[p]`` up to ``first[p + 1]``, in order around it.
A box is a row ``x0 y0 z0 x1 y1 z1``.
"""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import helper
from amprep.kernels.meshes.half_space import clip_to_half_space

MOST_CORNERS = 64
"""Greatest number of corners of a polygon that is clipped; each half-space adds one."""

ROUNDING = 1e-9
"""Length (mm) beyond a box that is rounding: what reaches no further out is inside."""

_STACK = 64
"""Pieces of one polygon that wait to be clipped: at most six for each box."""


@helper
def normal_component(triangle: Floats, axis: int) -> float:
    """Return a component of the normal of a triangle, the first three corners, that is twice as long as its area."""
    b, c = (axis + 1) % 3, (axis + 2) % 3
    return float(
        (triangle[1, b] - triangle[0, b]) * (triangle[2, c] - triangle[0, c])
        - (triangle[1, c] - triangle[0, c]) * (triangle[2, b] - triangle[0, b])
    )


@helper
def measure(polygon: Floats, count: int, bounds: Floats) -> None:
    """Write the enclosing box of ``polygon[:count]`` to ``bounds``, ``(6,)``."""
    for c in range(3):
        low = polygon[0, c]
        high = low
        for i in range(1, count):
            low = min(low, polygon[i, c])
            high = max(high, polygon[i, c])
        bounds[c] = low
        bounds[c + 3] = high


@helper
def _relation(bounds: Floats, box: Floats) -> int:
    """Return 1 if the box contains the bounds, -1 if their interiors are apart, else 0."""
    inside = True
    for c in range(3):
        if bounds[c + 3] <= box[c] and bounds[c] < box[c] - ROUNDING:
            return -1
        if bounds[c] >= box[c + 3] and bounds[c + 3] > box[c + 3] + ROUNDING:
            return -1
        if bounds[c] < box[c] - ROUNDING or bounds[c + 3] > box[c + 3] + ROUNDING:
            inside = False
    return 1 if inside else 0


@helper
def _cut(
    source: Floats, count: int, axis: int, bound: float, sign: float, solid: bool, target: Floats
) -> int:
    """Clip a polygon, or a box given by its least and its greatest corner; return the number of corners."""
    if not solid:
        return int(clip_to_half_space(source, count, axis, bound, sign, target))
    for c in range(3):
        target[0, c] = source[0, c]
        target[1, c] = source[1, c]
    if sign > 0.0:
        target[0, axis] = max(source[0, axis], bound)
    else:
        target[1, axis] = min(source[1, axis], bound)
    return 2 if target[0, axis] <= target[1, axis] else 0


@njit(cache=True)
def clip_outside(
    points: Floats, corners: Int64s, first: Int64s, solid: bool, boxes: Floats, out: Floats, ends: Int64s
) -> int:
    """Write what is left of the polygons outside the union of closed boxes; return the number of pieces.

    Strategy: most polygons are inside one box, and dropped, or apart from all, and copied. Any other one is
    subtracted box by box: each face of the box in turn cuts off the piece beyond it, which goes on to the next
    box; what remains after six faces is inside. The pieces wait on a stack.

    Parameters
    ----------
    points, corners, first
        The polygons, each of at most `MOST_CORNERS` corners.
    solid
        Whether the corners are least and greatest corners of boxes, which are clipped instead.
    boxes
        ``(k, 6)``.
    out, ends
        Receive the corners of the pieces, and ``ends[0] = 0`` and the end of each piece in `out`.

    Returns
    -------
    int
        Number of pieces; -1 if `out` or `ends` is too small.
    """
    stack = np.empty((_STACK, MOST_CORNERS, 3))
    counts = np.empty(_STACK, np.int64)
    levels = np.empty(_STACK, np.int64)
    beyond = np.empty((MOST_CORNERS, 3))
    inside = np.empty((MOST_CORNERS, 3))
    bounds = np.empty(6)
    pieces, used = 0, 0
    ends[0] = 0
    for p in range(len(first) - 1):
        count = first[p + 1] - first[p]
        for i in range(count):
            at = corners[first[p] + i]
            for c in range(3):
                inside[i, c] = points[at, c]
        measure(inside, count, bounds)
        touched, covered = False, False
        for b in range(len(boxes)):
            relation = _relation(bounds, boxes[b])
            if relation == 1:
                covered = True
                break
            touched |= relation == 0
        if covered:
            continue
        if used + 8 * MOST_CORNERS >= len(out) or pieces + _STACK >= len(ends):
            return -1
        if not touched or count > MOST_CORNERS // 2:
            for i in range(count):
                for c in range(3):
                    out[used + i, c] = inside[i, c]
            used += count
            pieces += 1
            ends[pieces] = used
            continue
        for i in range(count):
            for c in range(3):
                stack[0, i, c] = inside[i, c]
        counts[0], levels[0], top = count, 0, 1
        while top > 0:
            top -= 1
            count, level = counts[top], levels[top]
            for i in range(count):
                for c in range(3):
                    inside[i, c] = stack[top, i, c]
            kept = True
            while level < len(boxes) and kept:
                measure(inside, count, bounds)
                relation = _relation(bounds, boxes[level])
                if relation == 1:
                    kept = False
                elif relation == 0:
                    box = boxes[level]
                    for face in range(6):
                        axis, sign = face % 3, -1.0 if face < 3 else 1.0
                        crossed = False
                        for i in range(count):
                            crossed |= sign * (inside[i, axis] - box[face]) > ROUNDING
                        if not crossed:
                            continue
                        counts[top] = _cut(inside, count, axis, box[face], sign, solid, stack[top])
                        levels[top] = level + 1
                        top += 1
                        count = _cut(inside, count, axis, box[face], -sign, solid, beyond)
                        for i in range(count):
                            for c in range(3):
                                inside[i, c] = beyond[i, c]
                        if count == 0:
                            break
                    kept = False
                level += 1
            if kept:
                if used + count >= len(out) or pieces + 1 >= len(ends):
                    return -1
                for i in range(count):
                    for c in range(3):
                        out[used + i, c] = inside[i, c]
                used += count
                pieces += 1
                ends[pieces] = used
    return pieces
