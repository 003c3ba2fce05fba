"""Find narrow places along the outlines of regions: waists, and places that no disc near them covers."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import kernel, uncounted
from amprep.kernels.supports.narrow_ends import OutlineTurns
from amprep.kernels.supports.outlines import PlaneOutlines

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


_OPPOSITE = 0.7
"""Cosine of the largest angle at which the shortest line across a waist meets the other side."""


class OutlineSides(NamedTuple):
    """The outlines in a plane, with a grid of squares that finds the sides near a point.

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


class SideGrids(NamedTuple):
    """The grids of the planes: least corner ``(p, 2)`` mm, size of squares ``(p,)`` mm, numbers of squares ``(p, 2)``.

    The other fields are room for one grid, see `OutlineSides`: `corner` and `shape` ``(2,)``, `first` for the most
    squares of a plane and two, and `side` for the most pieces of sides in a plane.
    """

    low: Floats
    square: Floats
    squares: Int64s
    corner: Floats
    shape: Int64s
    first: Int64s
    side: Int64s


@kernel
def keep_narrow_places(
    planes: PlaneOutlines, turns: OutlineTurns, grids: SideGrids, chosen: Bools, inwards: Bools, width: float
) -> None:
    """Add the corners at waists to the chosen vertices, and drop those that discs near them cover on all sides.

    Strategy. A place is thin if no disc of the least width that fits into the region covers it, corners included. So
    points on the outline are looked at, at the vertex and up to two widths beside it. Near each a disc is sought: it
    begins inside, and moves away from the nearest side until it fits. A fin longer than a width has its end beyond the
    discs. A waist that is so long that discs at its two ends do not cover it has such a point within two widths of its
    corner. Sides are listed in a grid, only in the planes in which there are such vertices.

    Parameters
    ----------
    planes, turns
        Outlines of the regions in all planes, and the neighbours of their vertices.
    grids
        The grids, with room for one of them.
    chosen
        ``(n,)`` in and out: the vertices that may be narrow ends; those and the waists that are not covered.
    inwards
        ``(n,)`` vertices at which the outline turns inwards, which may be corners of waists.
    width
        Least width, mm.
    """
    for plane in range(len(planes.begin) - 1):
        begin, end = planes.first[planes.begin[plane]], planes.first[planes.begin[plane + 1]]
        vertex = begin
        while vertex < end and not chosen[vertex] and not inwards[vertex]:
            vertex += 1
        if vertex == end:
            continue
        _list_sides(planes.points, turns, grids, plane, begin, end)
        outlines = OutlineSides(
            planes.points,
            turns.after,
            turns.before,
            grids.corner,
            grids.square[plane],
            grids.shape,
            grids.first,
            grids.side,
        )
        for vertex in range(begin, end):
            if not chosen[vertex] and not (inwards[vertex] and _is_waist(outlines, vertex, width)):
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
def _list_sides(
    points: Floats, turns: OutlineTurns, grids: SideGrids, plane: int, begin: int, end: int
) -> None:
    """List the sides of a plane in the squares of its grid, in pieces that are at most half as long as a square."""
    first, count = grids.first, grids.squares[plane, 0] * grids.squares[plane, 1]
    for axis in range(2):
        grids.corner[axis], grids.shape[axis] = grids.low[plane, axis], grids.squares[plane, axis]
    for place in range(count + 2):
        first[place] = 0
    for listing in range(2):
        for vertex in range(begin, end):
            pieces = max(int(np.ceil(2.0 * turns.length[vertex] / grids.square[plane])), 1)
            for number in range(pieces):
                place = _square_of(points, turns.after[vertex], vertex, (number + 0.5) / pieces, grids, plane)
                if listing:
                    grids.side[first[place + 1]] = vertex
                    first[place + 1] += 1
                else:
                    first[place + 2] += 1
        for place in range(0 if listing else count):
            first[place + 2] += first[place + 1]


@uncounted
def _square_of(points: Floats, after: int, vertex: int, part: float, grids: SideGrids, plane: int) -> int:
    """Return the number of the square in which a point of a side is, at a fraction of its length."""
    square = grids.square[plane]
    x = points[vertex, 0] + part * (points[after, 0] - points[vertex, 0])
    y = points[vertex, 1] + part * (points[after, 1] - points[vertex, 1])
    column, row = int((x - grids.low[plane, 0]) / square), int((y - grids.low[plane, 1]) / square)
    return row * grids.squares[plane, 0] + column


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
def _is_waist(outlines: OutlineSides, vertex: int, width: float) -> bool:
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
            if _TOUCH < distance < width and dx * along_y - dy * along_x > _OPPOSITE * distance:
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
