"""Candidate positions of boxes in a build, compiled: whether they are feasible and how good they are."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.records import (
    AXIS_X,
    AXIS_Y,
    CENTRE,
    FLAT,
    GAP,
    LOW,
    MERIT_OF,
    PAIR_SLACK,
    PHASE,
    RADIUS,
    SLACK,
    TOUCHING,
    WEIGHT,
    BoxInstance,
)
from amprep.kernels.helper import uncounted

MOST_SLIDES = 60
"""Greatest number of lines along which an orientation is slid to a round wall."""

BUILD, INDEX, PLACED, POINTS, LINES, MOVED, LEFT, WORK = 0, 1, 2, 3, 4, 6, 7, 8
"""Columns of the cursor: build; index in the ordering; boxes, points, lines (in x and in y) and items of the build;
items left; comparisons made."""

LAST = 6
"""Column of an extreme point: the box that last blocked an item there."""

MERIT, ORIENTATION, POSITION = 0, 1, 2
"""Columns of the best candidate."""

Point = tuple[float, float, float]
"""A position of the least corner, mm."""

Span = tuple[int, int]
"""The first box of an orientation, and the first box after them."""


class PassState(NamedTuple):
    """Work arrays of `pack`; they hold the state of a paused pass.

    Attributes
    ----------
    placed
        ``(m, 6)`` mm corners of the boxes in the open build, obstacles first.
    points
        ``(p, 7)`` extreme points, their residual space, and the box that last blocked an item there (-1: none).
    lines
        ``(2, l)`` coordinates of box sides in x and in y.
    candidates
        ``(c, 5)`` positions of one orientation to be tried: x, y, z, residual space, number of the point (-1: none).
    failed
        ``(types,)`` the last build in which an item type found no position.
    cursor
        ``(9,)`` see `BUILD`.
    best
        ``(5,)`` the best candidate, see `MERIT`.
    extents
        ``(n + 1, 2)`` height of each finished build, and area of the rectangle around its boxes.
    """

    placed: Floats
    points: Floats
    lines: Floats
    candidates: Floats
    failed: Int64s
    cursor: Int64s
    best: Floats
    extents: Floats


@uncounted
def feasible_height(
    own: Span,
    position: Point,
    highest: float,
    boxes: Floats,
    room: Floats,
    placed: Floats,
    count: int,
    obstacle_count: int,
) -> float:
    """Return the least height from the position's z to `highest` at which an orientation is feasible.

    If there is none, the result is -1 where the room is too small, or -2 - j where box j blocks the orientation.

    Parameters
    ----------
    own
        Boxes of the orientation, a span of `boxes`.
    boxes, room
        As in `BoxInstance`.
    placed
        ``(m, 6)`` mm boxes of the build; the first `count` are used.
    obstacle_count
        Number of obstacles, which are the first boxes; they give by the slack of the walls.
    """
    slack = room[SLACK]
    x, y, z = position
    first, last = own
    k = first
    while k < last:
        x0, x1 = x + boxes[k, 0], x + boxes[k, 3]
        y0, y1 = y + boxes[k, 1], y + boxes[k, 4]
        z0, z1 = z + boxes[k, 2], z + boxes[k, 5]
        if x0 < room[0] - slack or y0 < room[1] - slack or z0 < room[2] - slack:
            return -1.0
        if x1 > room[3] + slack or y1 > room[4] + slack or z1 > room[5] + slack:
            return -1.0
        if room[RADIUS] > 0.0:
            far_x = max(room[AXIS_X] - x0, x1 - room[GAP] - room[AXIS_X])
            far_y = max(room[AXIS_Y] - y0, y1 - room[GAP] - room[AXIS_Y])
            if far_x * far_x + far_y * far_y > (room[RADIUS] + slack) * (room[RADIUS] + slack):
                return -1.0
        raised = False
        for j in range(count):
            give = slack if j < obstacle_count else PAIR_SLACK
            over_x = x0 < placed[j, 3] - give and placed[j, 0] + give < x1
            if over_x and y0 < placed[j, 4] - give and placed[j, 1] + give < y1:
                over_z = z0 < placed[j, 5] - give and placed[j, 2] + give < z1
                if over_z and placed[j, 5] - boxes[k, 2] > highest:
                    return -2.0 - j
                if over_z:
                    z = placed[j, 5] - boxes[k, 2]
                    raised = True
                    break
        k = first if raised else k + 1
    return z


@uncounted
def contact_area(
    own: Span, position: Point, boxes: Floats, room: Floats, placed: Floats, count: int
) -> float:
    """Return the area in which the boxes touch walls and other boxes (Lodi, Martello, Vigo 2002)."""
    area, near = 0.0, room[SLACK]
    x, y, z = position
    for k in range(own[0], own[1]):
        x0, x1 = x + boxes[k, 0], x + boxes[k, 3]
        y0, y1 = y + boxes[k, 1], y + boxes[k, 4]
        z0, z1 = z + boxes[k, 2], z + boxes[k, 5]
        if abs(x0 - room[0]) <= near:
            area += (y1 - y0) * (z1 - z0)
        if abs(x1 - room[3]) <= near:
            area += (y1 - y0) * (z1 - z0)
        if abs(y0 - room[1]) <= near:
            area += (x1 - x0) * (z1 - z0)
        if abs(y1 - room[4]) <= near:
            area += (x1 - x0) * (z1 - z0)
        if abs(z0 - room[2]) <= near:
            area += (x1 - x0) * (y1 - y0)
        if abs(z1 - room[5]) <= near:
            area += (x1 - x0) * (y1 - y0)
        for j in range(count):
            shared_x = max(0.0, min(x1, placed[j, 3]) - max(x0, placed[j, 0]))
            shared_y = max(0.0, min(y1, placed[j, 4]) - max(y0, placed[j, 1]))
            shared_z = max(0.0, min(z1, placed[j, 5]) - max(z0, placed[j, 2]))
            if abs(x0 - placed[j, 3]) <= near or abs(x1 - placed[j, 0]) <= near:
                area += shared_y * shared_z
            if abs(y0 - placed[j, 4]) <= near or abs(y1 - placed[j, 1]) <= near:
                area += shared_x * shared_z
            if abs(z0 - placed[j, 5]) <= near or abs(z1 - placed[j, 2]) <= near:
                area += shared_x * shared_y
    return area


@uncounted
def _merit(orientation: int, position: Point, orientations: Floats, room: Floats, rule: Floats) -> float:
    """Return the merit of a position under `LOW` or `CENTRE`; it does not fall when z grows."""
    x, y, z = position
    x1, y1, z1 = (
        x + orientations[orientation, 0],
        y + orientations[orientation, 1],
        z + orientations[orientation, 2],
    )
    if rule[MERIT_OF] == CENTRE:
        far_x = max(room[AXIS_X] - x, x1 - room[GAP] - room[AXIS_X])
        far_y = max(room[AXIS_Y] - y, y1 - room[GAP] - room[AXIS_Y])
        return float(far_x * far_x + far_y * far_y + 1e-3 * (y + 1e-3 * x) + rule[WEIGHT + 2] * z1)
    return float(rule[WEIGHT] * x1 + rule[WEIGHT + 1] * y1 + rule[WEIGHT + 2] * z1)


@uncounted
def _blocks(
    j: int, own: Span, position: Point, boxes: Floats, room: Floats, placed: Floats, obstacle_count: int
) -> bool:
    """Return whether placed box j overlaps one of the boxes of an orientation."""
    give = room[SLACK] if j < obstacle_count else PAIR_SLACK
    x, y, z = position
    for k in range(own[0], own[1]):
        over_x = x + boxes[k, 0] < placed[j, 3] - give and placed[j, 0] + give < x + boxes[k, 3]
        over_y = y + boxes[k, 1] < placed[j, 4] - give and placed[j, 1] + give < y + boxes[k, 4]
        if (
            over_x
            and over_y
            and z + boxes[k, 2] < placed[j, 5] - give
            and placed[j, 2] + give < z + boxes[k, 5]
        ):
            return True
    return False


# Strategy of `choose`. Testing whether a position is feasible costs a loop over all boxes of the build, so it comes
# last. A candidate whose merit is no better than the best one is dropped first; for `RESIDUAL`, `LOW` and `CENTRE`
# the merit is known before the test. The box that last blocked an item at a point blocks the next
# item too, in most cases; it is tested first and alone. A candidate that may rise is raised from box to box, but no
# higher than the height at which its merit would equal the best one.
@uncounted
def choose(
    orientation: int,
    fixed_height: int,
    found: int,
    obstacle_count: int,
    instance: BoxInstance,
    rule: Floats,
    state: PassState,
) -> None:
    """Keep the feasible candidate of least merit in `state.best`.

    Parameters
    ----------
    fixed_height
        The first `fixed_height` candidates keep their height; the others may rise until they are feasible.
    found
        Number of candidates.
    obstacle_count
        Number of obstacles in the build.
    """
    placed, points, _, candidates, _, cursor, best, _ = state
    orientations, boxes, room = instance.orientations, instance.boxes, instance.room
    count = cursor[PLACED]
    own = (instance.first_box[orientation], instance.first_box[orientation + 1])
    simple = rule[MERIT_OF] == LOW or rule[MERIT_OF] == CENTRE
    for c in range(found):
        x, y, z = candidates[c, 0], candidates[c, 1], candidates[c, 2]
        merit = _merit(orientation, (x, y, z), orientations, room, rule) if simple else candidates[c, 3]
        if rule[MERIT_OF] != TOUCHING and merit >= best[MERIT]:
            continue
        highest, point = z, int(candidates[c, 4]) if c < fixed_height else -1
        if point >= 0 and points[point, LAST] >= 0.0:
            cursor[WORK] += 1
            j = int(points[point, LAST])
            if _blocks(j, own, (x, y, z), boxes, room, placed, obstacle_count):
                continue
        if c >= fixed_height and room[FLAT] == 0.0:
            highest = z + (best[MERIT] - merit) / rule[WEIGHT + 2] if simple else np.inf
        cursor[WORK] += count
        height = feasible_height(own, (x, y, z), highest, boxes, room, placed, count, obstacle_count)
        if height < 0.0:
            if point >= 0 and height <= -2.0:
                points[point, LAST] = -2.0 - height
            continue
        if rule[MERIT_OF] == TOUCHING:
            low = rule[WEIGHT] * x + rule[WEIGHT + 1] * y + rule[WEIGHT + 2] * height
            merit = 1e-9 * low - contact_area(own, (x, y, height), boxes, room, placed, count)
        elif simple:
            merit = _merit(orientation, (x, y, height), orientations, room, rule)
        if merit < best[MERIT]:
            best[MERIT], best[ORIENTATION] = merit, orientation
            best[POSITION], best[POSITION + 1], best[POSITION + 2] = x, y, height


@uncounted
def _add_ends(
    axis: int, start: float, length: float, across: float, room: Floats, candidates: Floats, found: int
) -> int:
    """Add the positions at both ends of the round wall; return the new number of candidates.

    Parameters
    ----------
    axis
        0 or 1; the box occupies `length` from `start` on along this axis, and `across` along the other one.
    """
    far = max(room[AXIS_X + axis] - start, start + length - room[AXIS_X + axis])
    if far > room[RADIUS]:
        return found
    half = np.sqrt(room[RADIUS] * room[RADIUS] - far * far)
    for end in range(2):
        slid = room[AXIS_Y - axis] + (half - across if end else -half)
        candidates[found, axis], candidates[found, 1 - axis] = start, slid
        candidates[found, 2], candidates[found, 3] = room[2], 0.0
        found += 1
    return found


@uncounted
def add_round_positions(
    orientation: int, instance: BoxInstance, rule: Floats, state: PassState, found: int
) -> int:
    """Add candidate positions on a round plate; return the new number of candidates.

    In an empty build these are the middle of the plate, or under `LOW` the starts of rows from the wall on. Else the
    orientation is slid along lines to the wall; under `LOW` only along the rows, unless the phase allows both.
    """
    room, candidates, lines, cursor = instance.room, state.candidates, state.lines, state.cursor
    size = instance.orientations[orientation]
    merit, phase = rule[MERIT_OF], int(rule[PHASE])
    rows = 1 if rule[WEIGHT + 1] > rule[WEIGHT] else 0
    empty = cursor[MOVED] == 0
    for axis in range(2):
        length, across = size[axis] - room[GAP], size[1 - axis] - room[GAP]
        if empty:
            start = room[AXIS_X + axis] - (length / 2.0 if phase & (1 + axis) else length + room[GAP] / 2.0)
            candidates[found, axis] = start
            while merit == LOW and axis == rows and start > room[axis]:
                found = _add_ends(axis, start, length, across, room, candidates, found)
                start -= length + room[GAP]
        elif merit != LOW or axis == rows or phase & 4:
            # with many lines the build is full of small boxes, and every second, third, ... line is enough
            stride = 1 + cursor[LINES + axis] // MOST_SLIDES
            for i in range(2 * (cursor[LINES + axis] // stride)):
                start = lines[axis, i // 2 * stride] - (i % 2) * size[axis]
                found = _add_ends(axis, start, length, across, room, candidates, found)
    if empty and merit != LOW:
        candidates[found, 2], candidates[found, 3] = room[2], 0.0
        found += 1
    return found


@uncounted
def add_crossings(own: Span, instance: BoxInstance, state: PassState, found: int) -> int:
    """Add all crossings of lines as candidates; return the new number of candidates.

    On a round plate a box may lie on either side of a line.
    """
    room, boxes, candidates = instance.room, instance.boxes, state.candidates
    lines, cursor = state.lines, state.cursor
    sides = 2 if room[RADIUS] > 0.0 else 1
    for k in range(own[0], own[1]):
        for i in range(sides * cursor[LINES]):
            for j in range(sides * cursor[LINES + 1]):
                candidates[found, 0] = lines[0, i // sides] - boxes[k, 3 * (i % sides)]
                candidates[found, 1] = lines[1, j // sides] - boxes[k, 1 + 3 * (j % sides)]
                candidates[found, 2], candidates[found, 3] = room[2], 0.0
                found += 1
    return found
