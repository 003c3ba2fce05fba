"""Extreme points, compiled: one constructive pass that packs items of boxes into builds in a given ordering.

After Crainic, Perboli and Tadei, *Extreme point-based heuristics for three-dimensional bin packing*,
INFORMS Journal on Computing 20 (2008), doi:10.1287/ijoc.1070.0250. Added to the paper: items of several boxes,
obstacles, builds without stacking, and more candidates for round plates, where extreme points alone are poor.
"""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.positions import (
    BUILD,
    INDEX,
    LAST,
    LEFT,
    LINES,
    MERIT,
    MOVED,
    ORIENTATION,
    PLACED,
    POINTS,
    POSITION,
    WORK,
    PassState,
    Point,
    Span,
    add_crossings,
    add_round_positions,
    choose,
)
from amprep.kernels.boxes.records import (
    FLAT,
    GRID,
    LEAST,
    PAIR_SLACK,
    RADIUS,
    SLACK,
    Arrangement,
    BoxInstance,
)
from amprep.kernels.helper import kernel, uncounted

FINISHED, PAUSED, GAVE_UP = 0, 1, 2
"""Results of `pack`: all items are placed; the work is used up, call again; more builds are needed than allowed."""

# Strategy. Known: the instance, an ordering of the items, a placement rule. First fit: a build is filled with every
# remaining item that still fits, in order, before the next build is opened. Within a build the item takes the
# candidate position of least merit. Candidates are the extreme points: projections of box corners onto the nearest
# box or wall below them, along each axis. Every new box shortens the residual spaces of the points and removes the
# points that it covers or that are of no use to any item; a single box that is longer than the residual space of a
# point cannot lie there and is not tested. Every box of an item of several boxes is tried at each point.
# Boxes touch exactly (`PAIR_SLACK` absorbs rounding, so errors do not add up); walls and obstacles do not move and
# give by the slack of the room. Time: for each item the number of points times the number of placed boxes.


@uncounted
def _residual_space(point: Point, space: Point, lo: Point, hi: Point) -> Point:
    """Return the residual space of a point beside a box; its first length is -1 when the box covers the point.

    The arguments are tuples of numbers: the function is called for each point and box and has to be inlined.
    """
    (x, y, z), (space_x, space_y, space_z), (x0, y0, z0), (x1, y1, z1) = point, space, lo, hi
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


@uncounted
def _shorten_points(room: Floats, placed: Floats, points: Floats, cursor: Int64s) -> None:
    """Shorten the residual spaces by the newest box; drop points that it covers or that are of no more use."""
    new = cursor[PLACED] - 1
    lo = placed[new, 0], placed[new, 1], placed[new, 2]
    hi = placed[new, 3], placed[new, 4], placed[new, 5]
    kept = 0
    for p in range(cursor[POINTS]):
        x, y, z, last = points[p, 0], points[p, 1], points[p, 2], points[p, LAST]
        space_x, space_y, space_z = _residual_space(
            (x, y, z), (points[p, 3], points[p, 4], points[p, 5]), lo, hi
        )
        if space_x >= room[LEAST] and space_y >= room[LEAST + 1] and space_z >= room[LEAST + 2]:
            points[kept, 0], points[kept, 1], points[kept, 2], points[kept, LAST] = x, y, z, last
            points[kept, 3], points[kept, 4], points[kept, 5] = space_x, space_y, space_z
            kept += 1
    cursor[POINTS] = kept


@uncounted
def _projection(point: Point, axis: int, room: Floats, placed: Floats, count: int) -> float:
    """Return the coordinate at which a point that moves down `axis` meets a box or the wall."""
    x, y, z = point
    rest = room[axis]
    start = (x if axis == 0 else y if axis == 1 else z) + PAIR_SLACK
    for j in range(count):
        if rest < placed[j, axis + 3] <= start:
            over_x = axis == 0 or placed[j, 0] <= x + PAIR_SLACK < placed[j, 3]
            over_y = axis == 1 or placed[j, 1] <= y + PAIR_SLACK < placed[j, 4]
            over_z = axis == 2 or placed[j, 2] <= z + PAIR_SLACK < placed[j, 5]
            if over_x and over_y and over_z:
                rest = placed[j, axis + 3]
    return float(rest)


@uncounted
def _add_point(point: Point, room: Floats, placed: Floats, points: Floats, cursor: Int64s) -> None:
    """Add a point with its residual space, unless a box covers it or it is known."""
    x, y, z = point
    known = cursor[POINTS]
    for p in range(known):
        if abs(points[p, 0] - x) + abs(points[p, 1] - y) + abs(points[p, 2] - z) <= PAIR_SLACK:
            return
    space_x, space_y, space_z = room[3] - x, room[4] - y, room[5] - z
    for j in range(cursor[PLACED]):
        if space_x < room[LEAST] or space_y < room[LEAST + 1] or space_z < room[LEAST + 2]:
            return
        space_x, space_y, space_z = _residual_space(
            (x, y, z),
            (space_x, space_y, space_z),
            (placed[j, 0], placed[j, 1], placed[j, 2]),
            (placed[j, 3], placed[j, 4], placed[j, 5]),
        )
    if space_x < room[LEAST] or space_y < room[LEAST + 1] or space_z < room[LEAST + 2]:
        return
    points[known, 0], points[known, 1], points[known, 2], points[known, LAST] = x, y, z, -1.0
    points[known, 3], points[known, 4], points[known, 5] = space_x, space_y, space_z
    cursor[POINTS] = known + 1


@uncounted
def _add_lines(new: int, placed: Floats, lines: Floats, cursor: Int64s) -> None:
    """Note the sides of a box in x and in y as lines, unless they are known."""
    for side in range(6):
        if side % 3 < 2:
            axis, known = side % 3, False
            for i in range(cursor[LINES + axis]):
                known = known or abs(lines[axis, i] - placed[new, side]) <= PAIR_SLACK
            if not known:
                lines[axis, cursor[LINES + axis]] = placed[new, side]
                cursor[LINES + axis] += 1


@uncounted
def _add_box(
    b: int,
    boxes: Floats,
    position: Point,
    room: Floats,
    placed: Floats,
    points: Floats,
    lines: Floats,
    cursor: Int64s,
) -> None:
    """Add box b, moved to a position, to the build: shorten points, add its extreme points and its lines."""
    x, y, z = position
    new = cursor[PLACED]
    for axis in range(3):
        shift = x if axis == 0 else y if axis == 1 else z
        placed[new, axis], placed[new, axis + 3] = boxes[b, axis] + shift, boxes[b, axis + 3] + shift
    cursor[PLACED] = new + 1
    _shorten_points(room, placed, points, cursor)
    cursor[WORK] += 7 * cursor[POINTS] + 12 * new
    flat = room[FLAT] != 0.0
    for axis in range(2 if flat else 3):
        for down in range(3):
            if down != axis:
                px = placed[new, 3] if axis == 0 else placed[new, 0]
                py = placed[new, 4] if axis == 1 else placed[new, 1]
                pz = placed[new, 5] if axis == 2 else placed[new, 2]
                rest = _projection((px, py, pz), down, room, placed, new)
                if down == 0:
                    px = rest
                elif down == 1:
                    py = rest
                else:
                    pz = rest
                _add_point((px, py, room[2] if flat else pz), room, placed, points, cursor)
    _add_lines(new, placed, lines, cursor)


@uncounted
def _open_build(obstacle_count: int, instance: BoxInstance, state: PassState) -> None:
    """Open a build: the least corner is its first point, the walls are its first lines; add the obstacles."""
    room, obstacles = instance.room, instance.obstacles
    placed, points, lines, cursor = state.placed, state.points, state.lines, state.cursor
    cursor[PLACED], cursor[POINTS], cursor[MOVED] = 0, 0, 0
    cursor[LINES], cursor[LINES + 1] = 1, 1
    lines[0, 0], lines[1, 0] = room[0], room[1]
    _add_point((room[0], room[1], room[2]), room, placed, points, cursor)
    for j in range(obstacle_count):
        _add_box(j, obstacles, (0.0, 0.0, 0.0), room, placed, points, lines, cursor)


@uncounted
def _measure_build(build: int, zones: int, state: PassState) -> None:
    """Note the height of a build and the area of the rectangle around its boxes in `state.extents`."""
    placed = state.placed
    x0 = y0 = np.inf
    x1 = y1 = z1 = 0.0
    for j in range(zones, state.cursor[PLACED]):
        x0, y0 = min(x0, placed[j, 0]), min(y0, placed[j, 1])
        x1, y1, z1 = max(x1, placed[j, 3]), max(y1, placed[j, 4]), max(z1, placed[j, 5])
    state.extents[build, 0], state.extents[build, 1] = z1, max(0.0, x1 - x0) * max(0.0, y1 - y0)


@uncounted
def _add_candidates(
    own: Span,
    size: Point,
    boxes: Floats,
    room: Floats,
    points: Floats,
    candidates: Floats,
    cursor: Int64s,
) -> int:
    """Write the candidates of an orientation at the extreme points; return their number."""
    found, (first, last), (size_x, size_y, size_z) = 0, own, size
    # a single box that is longer than the residual space of a point cannot lie there
    least = -room[SLACK] if last - first == 1 else -np.inf
    flat = room[FLAT] != 0.0
    count = cursor[POINTS]
    cursor[WORK] += count
    for p in range(count):
        over_x, over_y, over_z = points[p, 3] - size_x, points[p, 4] - size_y, points[p, 5] - size_z
        if over_x >= least and over_y >= least and over_z >= least:
            for k in range(first, last):
                candidates[found, 0] = points[p, 0] - boxes[k, 0]
                candidates[found, 1] = points[p, 1] - boxes[k, 1]
                candidates[found, 2] = room[2] if flat else points[p, 2] - boxes[k, 2]
                candidates[found, 3] = over_x + over_y + over_z
                candidates[found, 4] = p
                found += 1
    return found


@kernel
def pack(
    order: Int64s,
    instance: BoxInstance,
    first_obstacles: int,
    rule: Floats,
    most_builds: int,
    work: float,
    arrangement: Arrangement,
    state: PassState,
) -> int:
    """Pack the items of `order` into at most `most_builds` builds; pause after `work` comparisons.

    Begin with a cursor of 0 but LEFT = len(order), with `failed` and `arrangement.build` all -1. To go on after
    PAUSED, call again with the same arguments. Several items of one type cost one failed search per build.

    Parameters
    ----------
    order
        ``(m,)`` int64 items.
    first_obstacles
        Number of obstacles in the first build; every other build has the zones alone.
    rule
        ``(6,)`` placement rule, see `MERIT_OF`.
    arrangement, state
        Modified in place.

    Returns
    -------
    int
        FINISHED, PAUSED or GAVE_UP.
    """
    type_of, first_orientation, first_box, orientations, boxes, room, _, zones = instance
    placed, points, lines, candidates, failed, cursor, best, _ = state
    cursor[WORK] = 0
    while cursor[BUILD] < most_builds:
        build = cursor[BUILD]
        obstacle_count = first_obstacles if build == 0 else zones
        if cursor[INDEX] == 0:
            _open_build(obstacle_count, instance, state)
        while cursor[INDEX] < order.size:
            if cursor[WORK] > work:
                return PAUSED
            item = order[cursor[INDEX]]
            item_type = type_of[item]
            cursor[INDEX] += 1
            if arrangement.build[item] >= 0 or failed[item_type] == build:
                continue
            best[MERIT] = np.inf
            grid = cursor[LINES] * cursor[LINES + 1] <= rule[GRID]
            for o in range(first_orientation[item_type], first_orientation[item_type + 1]):
                own, size = (
                    (first_box[o], first_box[o + 1]),
                    (orientations[o, 0], orientations[o, 1], orientations[o, 2]),
                )
                found = _add_candidates(own, size, boxes, room, points, candidates, cursor)
                if cursor[MOVED] == 0 and not np.isnan(orientations[o, 3]):
                    # in an empty build the known feasible position is a candidate too
                    for i in range(3):
                        candidates[found, i] = orientations[o, 3 + i]
                    candidates[found, 3], candidates[found, 4] = 1e9, -1.0
                    found += 1
                fixed_height = found
                if room[RADIUS] > 0.0:
                    found = add_round_positions(o, instance, rule, state, found)
                if grid:
                    found = add_crossings(own, instance, state, found)
                if found:
                    cursor[WORK] += found
                    choose(o, fixed_height, found, obstacle_count, instance, rule, state)
            if best[MERIT] == np.inf:
                failed[item_type] = build
                continue
            chosen = int(best[ORIENTATION])
            arrangement.build[item], arrangement.orientation[item] = build, chosen
            for i in range(3):
                arrangement.position[item, i] = best[POSITION + i]
            position = (best[POSITION], best[POSITION + 1], best[POSITION + 2])
            for k in range(first_box[chosen], first_box[chosen + 1]):
                _add_box(k, boxes, position, room, placed, points, lines, cursor)
            cursor[MOVED] += 1
            cursor[LEFT] -= 1
        _measure_build(build, zones, state)
        cursor[BUILD] += 1
        cursor[INDEX] = 0
        if cursor[LEFT] == 0:
            return FINISHED
    return GAVE_UP
