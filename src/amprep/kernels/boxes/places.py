"""Places for boxes in a build, compiled: do they fit, how good are they, where are some on a round plate.

Records and constants of the packing kernels are here too; see `amprep.kernels.boxes.extreme_points`.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s

helper = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Of functions that only kernels call: they compile faster without wrappers, and are cached inside `pack`."""

PAIR_SLACK = 1e-6
"""mm; boxes that overlap by less touch."""

MOST_SLIDES = 60
"""Lines along which a variant is slid to a round wall, at most."""

FINISHED, PAUSED, GAVE_UP = 0, 1, 2
"""What `pack` returns: all placed; work used up, call again; more builds needed than allowed."""

RESIDUAL, LOW, TOUCHING, CENTRE = 0, 1, 2, 3
"""Merits: least residual space left; lowest weighted far corner; most contact; nearest to the axis."""

AXIS_X, AXIS_Y, RADIUS, GAP, SLACK, FLAT, LEAST = 6, 7, 8, 9, 10, 11, 12
"""Places in the room after its corners: axis, radius less clearance (0: box), clearance, slack, flatness, and
three residual spaces; points with less are of no use to any item."""

KIND, WEIGHT, GRID, PHASE = 0, 1, 4, 5
"""Places in the style: merit, three weights of the far corner, most crossings of lines tried, phase.

Bits of the phase, for round plates: 1 and 2 centre the first item in x and y, 4 also slides items to the wall
across the rows.
"""

BUILD, INDEX, PLACED, POINTS, LINES, MOVED, LEFT, WORK = 0, 1, 2, 3, 4, 6, 7, 8
"""Places in the cursor: build, index in the order; its boxes, points, lines, items; items left, work."""

LAST = 6
"""Place in a point: the box that was last in the way."""

MERIT, VARIANT, PLACE = 0, 1, 2
"""Places in the best candidate."""


class Shapes(NamedTuple):
    """What is packed. A kind is a volume with its orientations, a variant one orientation of it.

    Attributes
    ----------
    kind
        ``(n,)`` kind of each item.
    first_variant, first_box
        ``(kinds + 1,)`` and ``(variants + 1,)``: where the variants of a kind, the boxes of a variant start.
    variants
        ``(variants, 6)`` size of the enclosing box with clearance, and a place in an empty build (NaN: none).
    boxes
        ``(boxes, 6)`` corners relative to the enclosing box's least corner, clearance added to the upper one.
    """

    kind: Int64s
    first_variant: Int64s
    first_box: Int64s
    variants: Floats
    boxes: Floats


class Scratch(NamedTuple):
    """Work arrays of `pack`, which hold the state of a paused pass.

    Attributes
    ----------
    placed
        ``(m, 6)`` corners of the boxes in the open build, obstacles first.
    points
        ``(p, 7)`` extreme points, their residual space, and which box was last in the way there (-1: none).
    lines
        ``(2, l)`` where box sides lie in x and in y.
    candidates
        ``(c, 5)`` places of one variant to be tried: x, y, z, residual space, number of the point (-1: none).
    failed
        ``(kinds,)`` the last build in which a kind found no place.
    """

    placed: Floats
    points: Floats
    lines: Floats
    candidates: Floats
    failed: Int64s
    cursor: Int64s
    best: Floats


class Answer(NamedTuple):
    """Written by `pack`: build (-1: none) and variant ``(n,)``, place ``(n, 3)``, looks of each build.

    The looks ``(n + 1, 2)`` are the build's height and the area of the rectangle around its boxes.
    """

    build: Int64s
    variant: Int64s
    place: Floats
    looks: Floats


@helper
def settle(first, last, x, y, z, highest, boxes, room, placed, count, standing):
    """Return the least height from z to `highest` at which the boxes fit; or -2 - j, where box j is in the way.

    It is -1 when the room is.
    """
    slack = room[SLACK]
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
            give = slack if j < standing else PAIR_SLACK
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


@helper
def touching(first, last, x, y, z, boxes, room, placed, count):
    """Return the area with which the boxes touch walls and other boxes (Lodi, Martello, Vigo 2002)."""
    area, near = 0.0, room[SLACK]
    for k in range(first, last):
        x0, x1 = x + boxes[k, 0], x + boxes[k, 3]
        y0, y1 = y + boxes[k, 1], y + boxes[k, 4]
        z0, z1 = z + boxes[k, 2], z + boxes[k, 5]
        if abs(x0 - room[0]) <= near or abs(x1 - room[3]) <= near:
            area += (y1 - y0) * (z1 - z0)
        if abs(y0 - room[1]) <= near or abs(y1 - room[4]) <= near:
            area += (x1 - x0) * (z1 - z0)
        if abs(z0 - room[2]) <= near or abs(z1 - room[5]) <= near:
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


@helper
def _merit(variant, x, y, z, variants, room, style):
    """Return the merit of a place under `LOW` or `CENTRE`; never less at a greater z."""
    x1, y1, z1 = x + variants[variant, 0], y + variants[variant, 1], z + variants[variant, 2]
    if style[KIND] == CENTRE:
        far_x = max(room[AXIS_X] - x, x1 - room[GAP] - room[AXIS_X])
        far_y = max(room[AXIS_Y] - y, y1 - room[GAP] - room[AXIS_Y])
        return far_x * far_x + far_y * far_y + 1e-3 * (y + 1e-3 * x) + style[WEIGHT + 2] * z1
    return style[WEIGHT] * x1 + style[WEIGHT + 1] * y1 + style[WEIGHT + 2] * z1


@helper
def _in_the_way(j, first, last, x, y, z, boxes, room, placed, standing):
    """Whether placed box j overlaps one of the boxes."""
    give = room[SLACK] if j < standing else PAIR_SLACK
    for k in range(first, last):
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


@helper
def choose(variant, known, found, shapes, room, style, placed, points, cursor, standing, candidates, best):
    """Keep the feasible candidate of least merit in `best` (in place); those from `known` on may rise.

    What was last in the way at a point often is again: it is looked at first, or thousands of boxes take long.
    """
    count = cursor[PLACED]
    first, last = shapes.first_box[variant], shapes.first_box[variant + 1]
    simple = style[KIND] == LOW or style[KIND] == CENTRE
    for c in range(found):
        x, y, z = candidates[c, 0], candidates[c, 1], candidates[c, 2]
        merit = _merit(variant, x, y, z, shapes.variants, room, style) if simple else candidates[c, 3]
        if style[KIND] != TOUCHING and merit >= best[MERIT]:
            continue
        highest, point = z, int(candidates[c, 4]) if c < known else -1
        if point >= 0 and points[point, LAST] >= 0.0:
            cursor[WORK] += 1
            j = int(points[point, LAST])
            if _in_the_way(j, first, last, x, y, z, shapes.boxes, room, placed, standing):
                continue
        if c >= known and room[FLAT] == 0.0:
            # no higher than where it would still be better than the best
            highest = z + (best[MERIT] - merit) / style[WEIGHT + 2] if simple else np.inf
        cursor[WORK] += count
        height = settle(first, last, x, y, z, highest, shapes.boxes, room, placed, count, standing)
        if height < 0.0:
            if point >= 0 and height <= -2.0:
                points[point, LAST] = -2.0 - height
            continue
        if style[KIND] == TOUCHING:
            low = style[WEIGHT] * x + style[WEIGHT + 1] * y + style[WEIGHT + 2] * height
            merit = 1e-9 * low - touching(first, last, x, y, height, shapes.boxes, room, placed, count)
        elif simple:
            merit = _merit(variant, x, y, height, shapes.variants, room, style)
        if merit < best[MERIT]:
            best[MERIT], best[VARIANT] = merit, variant
            best[PLACE], best[PLACE + 1], best[PLACE + 2] = x, y, height


@helper
def _wall(axis, start, length, across, room, candidates, found):
    """Add the places at both ends of the round wall for a box with its low side across `axis` at `start`."""
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


@helper
def round_places(variant, variants, room, style, lines, cursor, candidates, found):
    """Add places for a round plate: when empty the middle, or rows from the wall on; else slid to the wall.

    Under `LOW` rows begin at the wall; other slides are tried only when the phase says so.
    """
    kind, phase = style[KIND], int(style[PHASE])
    rows = 1 if style[WEIGHT + 1] > style[WEIGHT] else 0
    empty = cursor[MOVED] == 0
    for axis in range(2):
        length, across = variants[variant, axis] - room[GAP], variants[variant, 1 - axis] - room[GAP]
        if empty:
            start = room[AXIS_X + axis] - (length / 2.0 if phase & (1 + axis) else length + room[GAP] / 2.0)
            candidates[found, axis] = start
            while kind == LOW and axis == rows and start > room[axis]:
                found = _wall(axis, start, length, across, room, candidates, found)
                start -= length + room[GAP]
        elif kind != LOW or axis == rows or phase & 4:
            # of many lines every other, third, ... does: the build is full of small boxes
            stride = 1 + cursor[LINES + axis] // MOST_SLIDES
            for i in range(2 * (cursor[LINES + axis] // stride)):
                start = lines[axis, i // 2 * stride] - (i % 2) * variants[variant, axis]
                found = _wall(axis, start, length, across, room, candidates, found)
    if empty and kind != LOW:
        candidates[found, 2], candidates[found, 3] = room[2], 0.0
        found += 1
    return found


@helper
def crossings(first, last, boxes, room, lines, cursor, candidates, found):
    """Add all crossings of lines; on a round plate boxes may lie on either side of a line."""
    sides = 2 if room[RADIUS] > 0.0 else 1
    for k in range(first, last):
        for i in range(sides * cursor[LINES]):
            for j in range(sides * cursor[LINES + 1]):
                candidates[found, 0] = lines[0, i // sides] - boxes[k, 3 * (i % sides)]
                candidates[found, 1] = lines[1, j // sides] - boxes[k, 1 + 3 * (j % sides)]
                candidates[found, 2], candidates[found, 3] = room[2], 0.0
                found += 1
    return found
