"""Extreme points, compiled: one pass that packs items of boxes into builds in a given order.

After Crainic, Perboli and Tadei, *Extreme point-based heuristics for three-dimensional bin packing*,
INFORMS Journal on Computing 20 (2008), doi:10.1287/ijoc.1070.0250. A build is filled with every remaining
item that still fits, in order, before the next one is opened, which is first fit over the builds; within a
build the item takes the candidate place of least merit. Added to the paper: items of several boxes (every
box's corner is tried at a point), obstacles, builds without stacking, and candidates for a round plate, where
extreme points alone are poor.

Clearance is in the data: each box is longer by it at its upper sides, and the walls and obstacles are moved
to match, so that boxes which touch here keep it there. Boxes touch exactly (`PAIR_SLACK` absorbs rounding, so
that errors do not add up); walls and obstacles, which do not move, give by the room's slack.
"""

import numpy as np
from numba import njit

from amprep.kernels.boxes.places import (
    BUILD,
    FINISHED,
    FLAT,
    GAVE_UP,
    GRID,
    INDEX,
    LAST,
    LEAST,
    LEFT,
    LINES,
    MERIT,
    MOVED,
    PAIR_SLACK,
    PAUSED,
    PLACE,
    PLACED,
    POINTS,
    RADIUS,
    SLACK,
    VARIANT,
    WORK,
    choose,
    crossings,
    helper,
    round_places,
)


@helper
def _shortened(x, y, z, space_x, space_y, space_z, x0, y0, z0, x1, y1, z1):
    """Return the residual space of a point beside a box; the first is -1 when the box covers the point.

    Numbers only: called for each point and box, it has to be inlined.
    """
    px, py, pz = x + PAIR_SLACK, y + PAIR_SLACK, z + PAIR_SLACK
    in_x, in_y, in_z = x0 <= px < x1, y0 <= py < y1, z0 <= pz < z1
    if in_y and in_z:
        if in_x:
            return -1.0, space_y, space_z
        if x0 > px:
            return min(space_x, x0 - x), space_y, space_z
    elif in_x and in_z and y0 > py:
        return space_x, min(space_y, y0 - y), space_z
    elif in_x and in_y and z0 > pz:
        return space_x, space_y, min(space_z, z0 - z)
    return space_x, space_y, space_z


@helper
def _prune(points, new, placed, room, cursor):
    """Shorten the residual spaces by a new box; drop points it covers or leaves too little (in place)."""
    x0, y0, z0 = placed[new, 0], placed[new, 1], placed[new, 2]
    x1, y1, z1 = placed[new, 3], placed[new, 4], placed[new, 5]
    kept = 0
    for p in range(cursor[POINTS]):
        x, y, z, last = points[p, 0], points[p, 1], points[p, 2], points[p, LAST]
        space_x, space_y, space_z = _shortened(
            x, y, z, points[p, 3], points[p, 4], points[p, 5], x0, y0, z0, x1, y1, z1
        )
        if space_x >= room[LEAST] and space_y >= room[LEAST + 1] and space_z >= room[LEAST + 2]:
            points[kept, 0], points[kept, 1], points[kept, 2], points[kept, LAST] = x, y, z, last
            points[kept, 3], points[kept, 4], points[kept, 5] = space_x, space_y, space_z
            kept += 1
    cursor[POINTS] = kept


@helper
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


@helper
def _add_point(x, y, z, room, placed, points, cursor):
    """Add a point and its residual space, unless it is covered or known (modified in place)."""
    known = cursor[POINTS]
    for p in range(known):
        if abs(points[p, 0] - x) + abs(points[p, 1] - y) + abs(points[p, 2] - z) <= PAIR_SLACK:
            return
    space_x, space_y, space_z = room[3] - x, room[4] - y, room[5] - z
    for j in range(cursor[PLACED]):
        if space_x < room[LEAST] or space_y < room[LEAST + 1] or space_z < room[LEAST + 2]:
            return
        space_x, space_y, space_z = _shortened(
            x, y, z, space_x, space_y, space_z,
            placed[j, 0], placed[j, 1], placed[j, 2], placed[j, 3], placed[j, 4], placed[j, 5],
        )  # fmt: skip
    if space_x < room[LEAST] or space_y < room[LEAST + 1] or space_z < room[LEAST + 2]:
        return
    points[known, 0], points[known, 1], points[known, 2], points[known, LAST] = x, y, z, -1.0
    points[known, 3], points[known, 4], points[known, 5] = space_x, space_y, space_z
    cursor[POINTS] = known + 1


@helper
def _add_box(b, boxes, x, y, z, room, placed, points, lines, cursor):
    """Put box b, moved, into the build: prune points, add its projections and lines (modified in place)."""
    new = cursor[PLACED]
    for axis in range(3):
        shift = x if axis == 0 else y if axis == 1 else z
        placed[new, axis], placed[new, axis + 3] = boxes[b, axis] + shift, boxes[b, axis + 3] + shift
    cursor[PLACED] = new + 1
    _prune(points, new, placed, room, cursor)
    cursor[WORK] += 7 * cursor[POINTS] + 12 * new
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


@helper
def _open(standing, room, obstacles, placed, points, lines, cursor):
    """Start a build: the least corner as first point, the walls as first lines, then the obstacles."""
    cursor[PLACED], cursor[POINTS], cursor[MOVED] = 0, 0, 0
    cursor[LINES], cursor[LINES + 1] = 1, 1
    lines[0, 0], lines[1, 0] = room[0], room[1]
    _add_point(room[0], room[1], room[2], room, placed, points, cursor)
    for j in range(standing):
        _add_box(j, obstacles, 0.0, 0.0, 0.0, room, placed, points, lines, cursor)


@helper
def _look(zones, placed, count, build, looks):
    """Note a build's height and the area of the rectangle around its boxes (looks modified in place)."""
    x0 = y0 = np.inf
    x1 = y1 = z1 = 0.0
    for j in range(zones, count):
        x0, y0 = min(x0, placed[j, 0]), min(y0, placed[j, 1])
        x1, y1, z1 = max(x1, placed[j, 3]), max(y1, placed[j, 4]), max(z1, placed[j, 5])
    looks[build, 0], looks[build, 1] = z1, max(0.0, x1 - x0) * max(0.0, y1 - y0)


@njit(cache=True)
def pack(order, shapes, room, obstacles, zones, style, most_builds, work, answer, scratch):
    """Pack the items of `order` into at most `most_builds` builds; pause after `work` comparisons.

    Start with the cursor all 0 but LEFT = len(order), `failed` and `answer.build` all -1; to go on after
    PAUSED call again with the same arguments. Several items of one kind cost one failed search a build.

    Parameters
    ----------
    order
        ``(m,)`` int64 items.
    room
        ``(15,)`` mm: corners, then what `AXIS_X` and so on name.
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
    cursor[WORK] = 0
    slack, flat, is_round = room[SLACK], room[FLAT] != 0.0, room[RADIUS] > 0.0
    while cursor[BUILD] < most_builds:
        build = cursor[BUILD]
        standing = obstacles.shape[0] if build == 0 else zones
        if cursor[INDEX] == 0:
            _open(standing, room, obstacles, placed, points, lines, cursor)
        while cursor[INDEX] < order.size:
            if cursor[WORK] > work:
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
                count, size_x, size_y, size_z = cursor[POINTS], variants[v, 0], variants[v, 1], variants[v, 2]
                cursor[WORK] += count
                for p in range(count):
                    over_x, over_y, over_z = (
                        points[p, 3] - size_x,
                        points[p, 4] - size_y,
                        points[p, 5] - size_z,
                    )
                    if over_x >= least and over_y >= least and over_z >= least:
                        for k in range(first, last):
                            candidates[found, 0] = points[p, 0] - boxes[k, 0]
                            candidates[found, 1] = points[p, 1] - boxes[k, 1]
                            candidates[found, 2] = room[2] if flat else points[p, 2] - boxes[k, 2]
                            candidates[found, 3] = over_x + over_y + over_z
                            candidates[found, 4] = p
                            found += 1
                if empty and not np.isnan(variants[v, 3]):
                    for i in range(3):
                        candidates[found, i] = variants[v, 3 + i]
                    candidates[found, 3], candidates[found, 4] = 1e9, -1.0
                    found += 1
                known = found
                if is_round:
                    found = round_places(v, variants, room, style, lines, cursor, candidates, found)
                if grid:
                    found = crossings(first, last, boxes, room, lines, cursor, candidates, found)
                if found:
                    cursor[WORK] += found
                    choose(
                        v, known, found, shapes, room, style, placed, points, cursor, standing, candidates, best
                    )  # fmt: skip
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
