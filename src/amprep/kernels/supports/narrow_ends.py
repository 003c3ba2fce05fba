"""Find where the outlines of regions turn back within a width, in many planes at once."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import kernel, uncounted
from amprep.kernels.supports.outlines import PlaneOutlines

_TURN = np.radians(145.0)
"""Angle by which an outline turns at a narrow end; sharper corners than the rest to 180 degrees are narrow ends."""

_WEDGE = np.radians(190.0)
"""Angle by which an outline turns at the wider end of a wedge."""

_WEDGE_SPAN = 1.4
"""Length (in widths) of the end of a wedge."""

_INWARDS = np.radians(5.0)
"""Angle by which an outline turns inwards at the corner of a waist."""

_STUBBY, _SHORT = 0.6, 6.0
"""Twice the area over the perimeter, and the perimeter (both in widths), up to which a whole piece may be too thin.

Half a round pin whose radius is the width has 0.61 and 5.1, and its ends are longer than the width."""

_VERTICES = 4
"""Largest number of vertices of a narrow end."""


class ThinLimits(NamedTuple):
    """What is thin in a section.

    Attributes
    ----------
    width, area
        Least width (mm) and area (mm2).
    corner
        How far (in widths) corners reach beyond discs that fit.
    narrow
        Twice the area over the perimeter (in widths) up to which a piece may be too thin everywhere.
    """

    width: float
    area: float
    corner: float
    narrow: float


class OutlineTurns(NamedTuple):
    """The vertices of outlines ``(n,)``: the next one and the one before, the length (mm) to the next, and the turn."""

    after: Int64s
    before: Int64s
    length: Floats
    turn: Floats


class OutlineBoxes(NamedTuple):
    """The boxes of outlines ``(c, 2)`` mm, whether they have no thin place for certain, whether they are holes."""

    low: Floats
    high: Floats
    compact: Bools
    hole: Bools


class NarrowVertices(NamedTuple):
    """Vertices ``(n,)`` that may be corners of waists or narrow ends, and those of outlines that are small."""

    inwards: Bools
    ends: Bools
    small: Bools


@kernel
def find_narrow_vertices(
    outlines: PlaneOutlines,
    waists: Bools,
    limits: ThinLimits,
    turns: OutlineTurns,
    boxes: OutlineBoxes,
    found: NarrowVertices,
) -> None:
    """Find the vertices at which regions may be thin.

    Parameters
    ----------
    outlines
        The outlines of all planes.
    waists
        ``(p,)`` whether corners at waists are looked for in a plane.
    limits
        Least width and area.
    turns, boxes
        Out: how the outlines turn, and their boxes.
    found
        Out: the vertices. False for all vertices in.
    """
    for plane in range(len(outlines.begin) - 1):
        begin, end = outlines.begin[plane], outlines.begin[plane + 1]
        for c in range(begin, end):
            _follow(outlines, c, turns, boxes)
            boxes.compact[c] = _is_compact(outlines, c, turns, boxes, limits)
        for hole in range(begin, end):
            for c in range(begin, end if boxes.hole[hole] else begin):
                if boxes.compact[c] and _encloses(boxes, c, hole):
                    boxes.compact[c] = False
        for c in range(begin, end):
            if boxes.compact[c]:
                continue
            small = _is_small(outlines, c, turns, limits)
            for i in range(outlines.first[c], outlines.first[c + 1]):
                found.small[i] = small
                found.ends[i] = not small and _turns_back(turns, i, limits.width)
                found.inwards[i] = not small and waists[plane] and turns.turn[i] < -_INWARDS


@uncounted
def _follow(outlines: PlaneOutlines, c: int, turns: OutlineTurns, boxes: OutlineBoxes) -> None:
    """Find the neighbours of the vertices of an outline, its turns, and its box."""
    points, begin, end = outlines.points, outlines.first[c], outlines.first[c + 1]
    boxes.low[c, 0] = boxes.low[c, 1] = np.inf
    boxes.high[c, 0] = boxes.high[c, 1] = -np.inf
    for i in range(begin, end):
        after = i + 1 if i + 1 < end else begin
        turns.after[i], turns.before[after] = after, i
        turns.length[i] = np.hypot(points[after, 0] - points[i, 0], points[after, 1] - points[i, 1])
        for axis in range(2):
            boxes.low[c, axis] = min(boxes.low[c, axis], points[i, axis])
            boxes.high[c, axis] = max(boxes.high[c, axis], points[i, axis])
    first = last = _heading(points, end - 1, begin)
    for i in range(begin, end):
        heading = first if i == end - 1 else _heading(points, i, turns.after[i])
        turns.turn[i] = (heading - last + np.pi) % (2.0 * np.pi) - np.pi
        last = heading


@uncounted
def _heading(points: Floats, start: int, end: int) -> float:
    """Return the direction from one point to another, rad."""
    return np.arctan2(points[end, 1] - points[start, 1], points[end, 0] - points[start, 0])


@uncounted
def _is_compact(
    outlines: PlaneOutlines, c: int, turns: OutlineTurns, boxes: OutlineBoxes, limits: ThinLimits
) -> bool:
    """Tell whether an outline has no thin place for certain, because of the discs around its middle that fit.

    The middle is that of the box. Of a disc around it that fits, all discs of the width are inside, and they cover all
    that is nearer than their reach.
    """
    points, total, turns_left = outlines.points, 0.0, True
    middle_x = (boxes.low[c, 0] + boxes.high[c, 0]) / 2.0
    middle_y = (boxes.low[c, 1] + boxes.high[c, 1]) / 2.0
    radius, farthest = np.inf, 0.0
    for i in range(outlines.first[c], outlines.first[c + 1]):
        after = turns.after[i]
        side_x, side_y = points[after, 0] - points[i, 0], points[after, 1] - points[i, 1]
        x, y = points[i, 0] - middle_x, points[i, 1] - middle_y
        cross = x * side_y - y * side_x
        total += cross
        turns_left = turns_left and cross > 0.0
        length2 = max(side_x * side_x + side_y * side_y, 1e-18)
        along = min(max(-(x * side_x + y * side_y) / length2, 0.0), 1.0)
        radius = min(radius, np.hypot(x + along * side_x, y + along * side_y))
        farthest = max(farthest, np.hypot(x, y))
    boxes.hole[c] = total <= 0.0
    # an outline that turns left around the middle everywhere contains it
    return bool(
        turns_left
        and radius > 0.51 * limits.width
        and np.pi * radius * radius > limits.area
        and farthest < radius + (limits.corner - 0.01) * limits.width
    )


@uncounted
def _encloses(boxes: OutlineBoxes, c: int, hole: int) -> bool:
    """Tell whether the box of an outline encloses that of a hole."""
    for axis in range(2):
        if boxes.low[c, axis] > boxes.low[hole, axis] or boxes.high[c, axis] < boxes.high[hole, axis]:
            return False
    return True


@uncounted
def _is_small(outlines: PlaneOutlines, c: int, turns: OutlineTurns, limits: ThinLimits) -> bool:
    """Tell whether an outline encloses a piece that is smaller than the area, or that may be too thin as a whole."""
    points, enclosed, around = outlines.points, 0.0, 0.0
    for i in range(outlines.first[c], outlines.first[c + 1]):
        after = turns.after[i]
        enclosed += (points[i, 0] * points[after, 1] - points[i, 1] * points[after, 0]) / 2.0
        around += turns.length[i]
    if enclosed <= 0.0:
        return False
    width = limits.width
    stubby = around < _SHORT * width and 2.0 * enclosed < _STUBBY * width * around
    return bool(enclosed < limits.area or stubby or 2.0 * enclosed < limits.narrow * width * around)


@uncounted
def _turns_back(turns: OutlineTurns, vertex: int, width: float) -> bool:
    """Tell whether a short stretch that turns back begins at a vertex."""
    last, span, total = vertex, 0.0, turns.turn[vertex]
    if total > _TURN:
        return True
    for _ in range(_VERTICES - 1):
        span += turns.length[last]
        last = turns.after[last]
        total += turns.turn[last]
        if (total > _TURN and span < width) or (total > _WEDGE and span < _WEDGE_SPAN * width):
            return True
    return False
