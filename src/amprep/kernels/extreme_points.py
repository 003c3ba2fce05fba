"""Extreme points, compiled: one pass that packs items of boxes into builds in a given order.

After Crainic, Perboli and Tadei, *Extreme point-based heuristics for three-dimensional bin packing*,
INFORMS Journal on Computing 20 (2008), doi:10.1287/ijoc.1070.0250. A build is filled with every remaining item that
still fits, in order, before the next one is opened, which is first fit over the builds; within a build the
item takes the candidate place of least merit. Added to the paper: items of several boxes (every box's corner is tried
at a point), obstacles, builds without stacking, and candidates for a round plate, where extreme points alone are poor.

Clearance is in the data: each box is longer by it at its upper sides, and so are the walls and obstacles moved, so
that boxes which touch here keep it there. Boxes touch exactly (`PAIR_SLACK` absorbs rounding, so that errors do not
add up); walls and obstacles, which do not move, give by the room's slack.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

PAIR_SLACK = 1e-6
"""mm; boxes that overlap by less touch."""

FINISHED, PAUSED, GAVE_UP = 0, 1, 2
"""What `pack` returns: all placed; tries used up, call again; more builds needed than allowed."""

RESIDUAL, LOW, TOUCHING, CENTRE = 0, 1, 2, 3
"""Merits: least residual space left; lowest weighted far corner; most contact; nearest to the axis."""

AXIS_X, AXIS_Y, RADIUS, GAP, SLACK, FLAT = 6, 7, 8, 9, 10, 11
"""Places in the room after its corners: the axis, radius less clearance (0: a box), clearance, slack, no stacking."""

KIND, WEIGHT, GRID, PHASE = 0, 1, 4, 5
"""Places in the style: merit, three weights of the far corner, most crossings of lines tried, phase.

Bits of the phase, for round plates: 1 and 2 centre the first item in x and y, 4 also slides items to the wall across the rows.
"""

BUILD, INDEX, PLACED, POINTS, LINES, MOVED, LEFT, TRIES = 0, 1, 2, 3, 4, 6, 7, 8
"""Places in the cursor: build, index in the order; boxes, points, lines in x and y, items in the build; items left, tries."""

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

    kind: Indices
    first_variant: Indices
    first_box: Indices
    variants: Array
    boxes: Array


class Scratch(NamedTuple):
    """Work arrays of `pack`, which hold the state of a paused pass.

    Attributes
    ----------
    placed
        ``(m, 6)`` corners of the boxes in the open build, obstacles first.
    points
        ``(p, 6)`` extreme points and their residual space.
    lines
        ``(2, l)`` where box sides lie in x and in y.
    candidates
        ``(c, 4)`` places of one variant to be tried: x, y, z, residual space.
    failed
        ``(kinds,)`` the last build in which a kind found no place.
    """

    placed: Array
    points: Array
    lines: Array
    candidates: Array
    failed: Indices
    cursor: Indices
    best: Array


class Answer(NamedTuple):
    """Written by `pack`: build (-1: none) and variant ``(n,)``, place ``(n, 3)``; ``(n + 1, 2)`` looks of each build.

    The looks are the build's height and the area of the rectangle around its boxes.
    """

    build: Indices
    variant: Indices
    place: Array
    looks: Array


@njit(cache=True)
def _settle(first, last, x, y, z, rise, boxes, room, placed, count, standing):
    """Return the least height from z up (z alone unless `rise`) at which the boxes fit; -1 for none."""
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
            if x0 < placed[j, 3] - give and placed[j, 0] + give < x1:
                if y0 < placed[j, 4] - give and placed[j, 1] + give < y1:
                    if z0 < placed[j, 5] - give and placed[j, 2] + give < z1:
                        if not rise:
                            return -1.0
                        z = placed[j, 5] - boxes[k, 2]
                        raised = True
                        break
        k = first if raised else k + 1
    return z


@njit(cache=True)
def _touching(first, last, x, y, z, boxes, room, placed, count):
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


@njit(cache=True)
def _merit(variant, x, y, z, variants, room, style):
    """Return the merit of a place under `LOW` or `CENTRE`; never less at a greater z."""
    x1, y1, z1 = x + variants[variant, 0], y + variants[variant, 1], z + variants[variant, 2]
    if style[KIND] == CENTRE:
        far_x = max(room[AXIS_X] - x, x1 - room[GAP] - room[AXIS_X])
        far_y = max(room[AXIS_Y] - y, y1 - room[GAP] - room[AXIS_Y])
        return far_x * far_x + far_y * far_y + 1e-3 * (y + 1e-3 * x) + style[WEIGHT + 2] * z1
    return style[WEIGHT] * x1 + style[WEIGHT + 1] * y1 + style[WEIGHT + 2] * z1


@njit(cache=True)
def _choose(variant, known, found, shapes, room, style, placed, count, standing, candidates, best):
    """Keep the feasible candidate of least merit in `best` (modified in place); those from `known` on may rise."""
    first, last = shapes.first_box[variant], shapes.first_box[variant + 1]
    simple = style[KIND] == LOW or style[KIND] == CENTRE
    for c in range(found):
        x, y, z = candidates[c, 0], candidates[c, 1], candidates[c, 2]
        merit = _merit(variant, x, y, z, shapes.variants, room, style) if simple else candidates[c, 3]
        if style[KIND] != TOUCHING and merit >= best[MERIT]:
            continue
        rise = c >= known and room[FLAT] == 0.0
        height = _settle(first, last, x, y, z, rise, shapes.boxes, room, placed, count, standing)
        if height < 0.0:
            continue
        if style[KIND] == TOUCHING:
            low = style[WEIGHT] * x + style[WEIGHT + 1] * y + style[WEIGHT + 2] * height
            merit = 1e-9 * low - _touching(first, last, x, y, height, shapes.boxes, room, placed, count)
        elif simple:
            merit = _merit(variant, x, y, height, shapes.variants, room, style)
        if merit < best[MERIT]:
            best[MERIT], best[VARIANT] = merit, variant
            best[PLACE], best[PLACE + 1], best[PLACE + 2] = x, y, height


@njit(cache=True)
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


@njit(cache=True)
def _round_places(variant, variants, room, style, lines, cursor, candidates, found):
    """Add places for a round plate: the middle or rows from the wall on when empty, else slid along lines to the wall.

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
            for i in range(2 * cursor[LINES + axis]):
                start = lines[axis, i // 2] - (i % 2) * variants[variant, axis]
                found = _wall(axis, start, length, across, room, candidates, found)
    if empty and kind != LOW:
        candidates[found, 2], candidates[found, 3] = room[2], 0.0
        found += 1
    return found


@njit(cache=True)
def _crossings(first, last, boxes, room, lines, cursor, candidates, found):
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


@njit(cache=True)
def _shorten(p, points, box, placed):
    """Shorten the residual space of a point in place by a box; say whether the box covers the point."""
    x, y, z = points[p, 0] + PAIR_SLACK, points[p, 1] + PAIR_SLACK, points[p, 2] + PAIR_SLACK
    in_x = placed[box, 0] <= x < placed[box, 3]
    in_y = placed[box, 1] <= y < placed[box, 4]
    in_z = placed[box, 2] <= z < placed[box, 5]
    if in_y and in_z and placed[box, 0] > x:
        points[p, 3] = min(points[p, 3], placed[box, 0] - points[p, 0])
    if in_x and in_z and placed[box, 1] > y:
        points[p, 4] = min(points[p, 4], placed[box, 1] - points[p, 1])
    if in_x and in_y and placed[box, 2] > z:
        points[p, 5] = min(points[p, 5], placed[box, 2] - points[p, 2])
    return in_x and in_y and in_z


@njit(cache=True)
def _fall(x, y, z, axis, room, placed, count):
    """Return where a point comes to rest that moves down `axis`: on a box or the wall."""
    rest = room[axis]
    start = (x if axis == 0 else y if axis == 1 else z) + PAIR_SLACK
    for j in range(count):
        if rest < placed[j, axis + 3] <= start:
            over_x = axis == 0 or placed[j, 0] <= x + PAIR_SLACK < placed[j, 3]
            over_y = axis == 1 or placed[j, 1] <= y + PAIR_SLACK < placed[j, 4]
            over_z = axis == 2 or placed[j, 2] <= z + PAIR_SLACK < placed[j, 5]
            if over_x and over_y and over_z:
                rest = placed[j, axis + 3]
    return rest


@njit(cache=True)
def _add_point(x, y, z, room, placed, points, cursor):
    """Add a point with its residual space, unless it is covered or known (points and cursor modified in place)."""
    known = cursor[POINTS]
    for p in range(known):
        if abs(points[p, 0] - x) + abs(points[p, 1] - y) + abs(points[p, 2] - z) <= PAIR_SLACK:
            return
    points[known, 0], points[known, 1], points[known, 2] = x, y, z
    points[known, 3], points[known, 4], points[known, 5] = room[3] - x, room[4] - y, room[5] - z
    if min(points[known, 3], points[known, 4], points[known, 5]) <= PAIR_SLACK:
        return
    for j in range(cursor[PLACED]):
        if _shorten(known, points, j, placed):
            return
    cursor[POINTS] = known + 1


@njit(cache=True)
def _add_box(b, boxes, x, y, z, room, placed, points, lines, cursor):
    """Put box b moved by x, y, z into the build: prune the points, add its projections and lines (modified in place)."""
    new = cursor[PLACED]
    for axis in range(3):
        shift = x if axis == 0 else y if axis == 1 else z
        placed[new, axis], placed[new, axis + 3] = boxes[b, axis] + shift, boxes[b, axis + 3] + shift
    cursor[PLACED] = new + 1
    kept = 0
    for p in range(cursor[POINTS]):
        if not _shorten(p, points, new, placed):
            for i in range(6):
                points[kept, i] = points[p, i]
            kept += 1
    cursor[POINTS] = kept
    flat = room[FLAT] != 0.0
    for axis in range(2 if flat else 3):
        for fall in range(3):
            if fall != axis:
                px = placed[new, 3] if axis == 0 else placed[new, 0]
                py = placed[new, 4] if axis == 1 else placed[new, 1]
                pz = placed[new, 5] if axis == 2 else placed[new, 2]
                rest = _fall(px, py, pz, fall, room, placed, new)
                if fall == 0:
                    px = rest
                elif fall == 1:
                    py = rest
                else:
                    pz = rest
                _add_point(px, py, room[2] if flat else pz, room, placed, points, cursor)
    for side in range(6):
        if side % 3 < 2:
            axis, known = side % 3, False
            for i in range(cursor[LINES + axis]):
                known = known or abs(lines[axis, i] - placed[new, side]) <= PAIR_SLACK
            if not known:
                lines[axis, cursor[LINES + axis]] = placed[new, side]
                cursor[LINES + axis] += 1


@njit(cache=True)
def _open(standing, room, obstacles, placed, points, lines, cursor):
    """Start a build: the least corner as first point, the walls as first lines, then the obstacles."""
    cursor[PLACED], cursor[POINTS], cursor[MOVED] = 0, 0, 0
    cursor[LINES], cursor[LINES + 1] = 1, 1
    lines[0, 0], lines[1, 0] = room[0], room[1]
    _add_point(room[0], room[1], room[2], room, placed, points, cursor)
    for j in range(standing):
        _add_box(j, obstacles, 0.0, 0.0, 0.0, room, placed, points, lines, cursor)


@njit(cache=True)
def _look(zones, placed, count, build, looks):
    """Note a build's height and the area of the rectangle around its boxes (looks modified in place)."""
    x0 = y0 = np.inf
    x1 = y1 = z1 = 0.0
    for j in range(zones, count):
        x0, y0 = min(x0, placed[j, 0]), min(y0, placed[j, 1])
        x1, y1, z1 = max(x1, placed[j, 3]), max(y1, placed[j, 4]), max(z1, placed[j, 5])
    looks[build, 0], looks[build, 1] = z1, max(0.0, x1 - x0) * max(0.0, y1 - y0)


@njit(cache=True)
def pack(order, shapes, room, obstacles, zones, style, most_builds, tries, answer, scratch):
    """Pack the items of `order` into at most `most_builds` builds; pause after `tries` candidate places.

    Start with the cursor all 0 but LEFT = len(order), `failed` and `answer.build` all -1; to go on after PAUSED
    call again with the same arguments. Several items of one kind cost one failed search a build.

    Parameters
    ----------
    order
        ``(m,)`` int64 items.
    room
        ``(12,)`` mm: corners, then what `AXIS_X` and so on name.
    obstacles, zones
        ``(m, 6)`` mm corners; the first `zones` stand in every build, the others in the first one.
    style
        ``(6,)`` how places are chosen, see `KIND`.

    Returns
    -------
    int
        FINISHED, PAUSED or GAVE_UP; `answer` and `scratch` are modified in place.
    """
    kinds, first_variant, first_box, variants, boxes = shapes
    placed, points, lines, candidates, failed, cursor, best = scratch
    cursor[TRIES] = 0
    slack, flat, is_round = room[SLACK], room[FLAT] != 0.0, room[RADIUS] > 0.0
    while cursor[BUILD] < most_builds:
        build = cursor[BUILD]
        standing = obstacles.shape[0] if build == 0 else zones
        if cursor[INDEX] == 0:
            _open(standing, room, obstacles, placed, points, lines, cursor)
        while cursor[INDEX] < order.size:
            if cursor[TRIES] > tries:
                return PAUSED
            item = order[cursor[INDEX]]
            kind = kinds[item]
            cursor[INDEX] += 1
            if answer.build[item] >= 0 or failed[kind] == build:
                continue
            best[MERIT] = np.inf
            empty = cursor[MOVED] == 0
            grid = cursor[LINES] * cursor[LINES + 1] <= style[GRID]
            for v in range(first_variant[kind], first_variant[kind + 1]):
                found, first, last = 0, first_box[v], first_box[v + 1]
                # a single box that is longer than a point's residual space cannot lie there
                least = -slack if last - first == 1 else -np.inf
                cursor[TRIES] += cursor[POINTS]
                for p in range(cursor[POINTS]):
                    over_x, over_y = points[p, 3] - variants[v, 0], points[p, 4] - variants[v, 1]
                    over_z = points[p, 5] - variants[v, 2]
                    if over_x >= least and over_y >= least and over_z >= least:
                        for k in range(first, last):
                            candidates[found, 0] = points[p, 0] - boxes[k, 0]
                            candidates[found, 1] = points[p, 1] - boxes[k, 1]
                            candidates[found, 2] = room[2] if flat else points[p, 2] - boxes[k, 2]
                            candidates[found, 3] = over_x + over_y + over_z
                            found += 1
                if empty and not np.isnan(variants[v, 3]):
                    for i in range(3):
                        candidates[found, i] = variants[v, 3 + i]
                    candidates[found, 3] = 1e9
                    found += 1
                known = found
                if is_round:
                    found = _round_places(v, variants, room, style, lines, cursor, candidates, found)
                if grid:
                    found = _crossings(first, last, boxes, room, lines, cursor, candidates, found)
                if found:
                    count = cursor[PLACED]
                    cursor[TRIES] += found
                    _choose(v, known, found, shapes, room, style, placed, count, standing, candidates, best)
            if best[MERIT] == np.inf:
                failed[kind] = build
                continue
            chosen = int(best[VARIANT])
            answer.build[item], answer.variant[item] = build, chosen
            for i in range(3):
                answer.place[item, i] = best[PLACE + i]
            for k in range(first_box[chosen], first_box[chosen + 1]):
                x, y, z = best[PLACE], best[PLACE + 1], best[PLACE + 2]
                _add_box(k, boxes, x, y, z, room, placed, points, lines, cursor)
            cursor[MOVED] += 1
            cursor[LEFT] -= 1
        _look(zones, placed, cursor[PLACED], build, answer.looks)
        cursor[BUILD] += 1
        cursor[INDEX] = 0
        if cursor[LEFT] == 0:
            return FINISHED
    return GAVE_UP
