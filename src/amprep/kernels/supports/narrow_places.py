"""Find narrow places along the outlines of a region: waists, and places that no disc near them covers."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import kernel, uncounted

_STATIONS = (0.0, 0.5, 1.0, 1.4, 2.2)
"""Distances (in widths) along the outline, both ways from a place, of the points that discs must cover."""

_TURNS = (0.0, 0.8, -0.8, 1.4, -1.4)
"""Directions (rad) from the left of the outline in which the search for a disc begins."""

_START = 0.8
"""Distance (in widths) from a point on the outline at which it begins."""

_MOVES = 8
"""Number of times that a disc is moved away from the nearest side."""

_FARTHEST = 1.75
"""Largest distance (in widths) of a point from the centre of a disc that covers it, corners included."""

_ROOM = 0.505
"""Radius (in widths) of the discs; a little more than half a width, because circles are polygons elsewhere."""

_TOUCH = 1e-6
"""Distance (mm) up to which a vertex is on a side."""


class OutlineSides(NamedTuple):
    """The outlines of a region, with a grid of squares that finds the sides near a point.

    Attributes
    ----------
    points
        ``(n, 2)`` mm, vertices of all outlines, the region to the left of each.
    after, before
        ``(n,)`` the next vertex of each, and the one before. Side i leads from vertex i to the next one.
    corner, square
        Least corner (mm) of the grid ``(2,)``, and the size of its squares, mm.
    shape
        ``(2,)`` number of squares in x and in y.
    first, side
        Sides ``side[first[k] : first[k + 1]]`` that may meet square k; x counts first.
    """

    points: Floats
    after: Int64s
    before: Int64s
    corner: Floats
    square: float
    shape: Int64s
    first: Int64s
    side: Int64s


@kernel
def keep_narrow_places(
    outlines: OutlineSides, chosen: Bools, inwards: Bools, width: float, opposite: float
) -> None:
    """Add the corners at waists to the chosen vertices, and drop those that discs near them cover on all sides.

    Strategy. A place is thin if no disc of the least width that fits into the region covers it, corners included. So
    points on the outline are looked at, at the vertex and up to two widths beside it. Near each a disc is sought: it
    begins inside, and moves away from the nearest side until it fits. A fin longer than a width has its end beyond the
    discs. A waist that is so long that discs at its two ends do not cover it has such a point within two widths of its
    corner.

    Parameters
    ----------
    outlines
        Outlines of the region.
    chosen
        ``(n,)`` in and out: the vertices that may be narrow ends; those and the waists that are not covered.
    inwards
        ``(n,)`` vertices at which the outline turns inwards, which may be corners of waists.
    width
        Least width, mm.
    opposite
        Cosine of the largest angle at which the shortest line across a waist meets the other side.
    """
    for vertex in range(len(chosen)):
        if not chosen[vertex] and not (inwards[vertex] and _is_waist(outlines, vertex, width, opposite)):
            continue
        chosen[vertex] = False
        disc_x, disc_y = np.inf, np.inf
        for k in range(2 * len(_STATIONS) - 1):
            forwards = k < len(_STATIONS)
            distance = _STATIONS[k if forwards else k - len(_STATIONS) + 1] * width
            disc_x, disc_y = _disc_at(outlines, vertex, distance, forwards, width, disc_x, disc_y)
            if disc_x == np.inf:
                chosen[vertex] = True
                break


@uncounted
def _squares_near(
    outlines: OutlineSides, low: float, high: float, axis: int, margin: float
) -> tuple[int, int]:
    """Return the first and the last row or column of squares within a distance (mm) of an interval."""
    first = int((low - margin - outlines.corner[axis]) / outlines.square)
    last = int((high + margin - outlines.corner[axis]) / outlines.square)
    return max(first, 0), min(last, outlines.shape[axis] - 1)


@uncounted
def _to_side(outlines: OutlineSides, side: int, x: float, y: float) -> tuple[float, float, float, float]:
    """Return the shortest vector (mm) from a point to a side, and the unit vector along the side."""
    points, end = outlines.points, outlines.after[side]
    along_x, along_y = points[end, 0] - points[side, 0], points[end, 1] - points[side, 1]
    length = np.hypot(along_x, along_y)
    if length == 0.0:
        return points[side, 0] - x, points[side, 1] - y, 0.0, 0.0
    along_x, along_y = along_x / length, along_y / length
    offset_x, offset_y = points[side, 0] - x, points[side, 1] - y
    step = min(max(-(offset_x * along_x + offset_y * along_y), 0.0), length)
    return offset_x + step * along_x, offset_y + step * along_y, along_x, along_y


@uncounted
def _is_waist(outlines: OutlineSides, vertex: int, width: float, opposite: float) -> bool:
    """Tell whether a side opposite to a vertex is nearer than the width."""
    x, y = outlines.points[vertex, 0], outlines.points[vertex, 1]
    margin = width + outlines.square / 4.0
    left, right = _squares_near(outlines, x, x, 0, margin)
    front, back = _squares_near(outlines, y, y, 1, margin)
    for row in range(front, back + 1):
        place = row * outlines.shape[0]
        for k in range(outlines.first[place + left], outlines.first[place + right + 1]):
            dx, dy, along_x, along_y = _to_side(outlines, outlines.side[k], x, y)
            distance = np.hypot(dx, dy)
            if _TOUCH < distance < width and dx * along_y - dy * along_x > opposite * distance:
                return True
    return False


@uncounted
def _disc_at(
    outlines: OutlineSides,
    vertex: int,
    distance: float,
    forwards: bool,
    width: float,
    known_x: float,
    known_y: float,
) -> tuple[float, float]:
    """Return the centre (mm) of a disc that covers a point of the outline, infinite for none.

    The point is at a distance (mm) along the outline from a vertex. The known disc is looked at first, because one disc
    often covers several points.
    """
    points, after, before = outlines.points, outlines.after, outlines.before
    side = vertex
    for _ in range(len(points)):
        side = side if forwards else before[side]
        end = after[side]
        length = np.hypot(points[end, 0] - points[side, 0], points[end, 1] - points[side, 1])
        if distance <= length:
            break
        distance -= length
        side = end if forwards else side
    part = distance / max(length, _TOUCH)
    part = part if forwards else 1.0 - part
    x = points[side, 0] + part * (points[end, 0] - points[side, 0])
    y = points[side, 1] + part * (points[end, 1] - points[side, 1])
    if np.hypot(known_x - x, known_y - y) <= _FARTHEST * width:
        return known_x, known_y
    heading = np.arctan2(points[end, 1] - points[side, 1], points[end, 0] - points[side, 0])
    for turn in _TURNS:
        # from the left, where the region is
        angle = heading + np.pi / 2.0 + turn
        centre_x, centre_y = x + _START * width * np.cos(angle), y + _START * width * np.sin(angle)
        for _ in range(_MOVES):
            dx, dy, distance, inside = _nearest(outlines, centre_x, centre_y, _FARTHEST * width)
            if inside and distance >= _ROOM * width:
                return centre_x, centre_y
            if distance < _TOUCH:
                break
            step = 1.01 * _ROOM * width / distance
            step = 1.0 - step if inside else 1.0 + step
            centre_x, centre_y = centre_x + step * dx, centre_y + step * dy
            if np.hypot(centre_x - x, centre_y - y) > _FARTHEST * width:
                break
    return np.inf, np.inf


@uncounted
def _nearest(outlines: OutlineSides, x: float, y: float, reach: float) -> tuple[float, float, float, bool]:
    """Return the vector (mm) to the nearest point of the outlines, its length, and whether a point is in the region.

    The nearest point must be within the reach (mm).
    """
    margin = reach + outlines.square / 4.0
    left, right = _squares_near(outlines, x, x, 0, margin)
    front, back = _squares_near(outlines, y, y, 1, margin)
    least, to_x, to_y, inside = np.inf, 0.0, 0.0, False
    for row in range(front, back + 1):
        place = row * outlines.shape[0]
        for k in range(outlines.first[place + left], outlines.first[place + right + 1]):
            side = outlines.side[k]
            dx, dy, along_x, along_y = _to_side(outlines, side, x, y)
            distance = np.hypot(dx, dy)
            if distance < least:
                least, to_x, to_y = distance, dx, dy
                inside = _is_left(outlines, side, dx, dy, along_x, along_y)
    return to_x, to_y, least, inside


@uncounted
def _is_left(outlines: OutlineSides, side: int, dx: float, dy: float, along_x: float, along_y: float) -> bool:
    """Tell whether the point from which the shortest vector leads to a side is in the region, if none is nearer."""
    across = along_x * dy - along_y * dx
    if np.abs(dx * along_x + dy * along_y) < _TOUCH * np.abs(across):
        return bool(across < 0.0)
    # the nearest point is a vertex, at which the outline turns inwards if the point is in the region
    points, after = outlines.points, outlines.after
    vertex = side if dx * along_x + dy * along_y > 0.0 else after[side]
    start, middle, end = points[outlines.before[vertex]], points[vertex], points[after[vertex]]
    turn = (middle[0] - start[0]) * (end[1] - middle[1]) - (middle[1] - start[1]) * (end[0] - middle[0])
    return bool(turn < 0.0)
