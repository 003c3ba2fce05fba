"""Guided separation: overlapping items move, one at a time, to the position of least weighted overlap."""

import numpy as np
from numba import njit

from amprep.kernels.guided_search import (
    EVERYWHERE,
    LONGER,
    MOVES,
    NEGLIGIBLE,
    READ,
    ROUNDS,
    SCANS,
    SHORTER,
    TRIES,
    VALUES_A_DEPTH,
    MoveRules,
    WeightGrowth,
    clamped,
    new_weight,
)
from amprep.kernels.helper import helper
from amprep.kernels.no_fit.depth import depth_at, depth_between, outside_circle
from amprep.kernels.no_fit.records import (
    NEXT,
    PAIRS,
    NoFitFields,
    PositionRange,
    SeparationState,
    ShapeLayout,
)
from amprep.kernels.no_fit.scan import add_overlaps, best_cells
from amprep.kernels.random_numbers import uniform

# Strategy. Overlaps are allowed and weighted. A round visits the overlapping items in random order. An item first
# descends from its position; where an overlap remains, it may also scan the whole build volume, on a grid of two
# steps, with its present shape, another of its shapes, or in another build, and descends from the best cells. After
# each round the weights of pairs that still overlap grow by 20 to 50 %, in proportion to their depth, and the others
# decay towards 1. So the search leaves local minima (guided local search: Voudouris, Tsang 1999,
# doi:10.1016/S0377-2217(98)00099-X; Umetani et al. 2009, doi:10.1111/j.1475-3995.2009.00707.x). A scan adds the
# samples of each near field line by line, some 1e9 a second; a descent reads a few hundred values.

GROWTH = WeightGrowth(least=1.2, most=1.5, decay=0.95)


@helper
def _together(layout, i, j):
    """Tell whether an item and another or an obstacle are in the same build."""
    return layout.build[i] == layout.build[j] or layout.build[j] == EVERYWHERE


@helper
def _depth_of(fields, layout, i, j, x, y, z):
    position = layout.position[j]
    return depth_at(
        fields, layout.shape[i], layout.shape[j], x - position[0], y - position[1], z - position[2]
    )


@helper
def _update_overlaps(fields, within, layout, items, state, i):
    """Compute the overlaps of item i with all others anew, and add pairs that overlap to the list."""
    x, y, z = layout.position[i]
    for j in range(layout.shape.size):
        before, depth = state.overlap[i, j], 0.0
        if j != i and _together(layout, i, j):
            depth = _depth_of(fields, layout, i, j, x, y, z)
        if depth == before:
            continue
        change = int(depth > 0.0) - int(before > 0.0)
        state.overlap[i, j] = depth
        state.touching[i] += change
        if j < items:
            state.overlap[j, i] = depth
            state.touching[j] += change
        _list(state, max(i, j) if j < items else i, min(i, j) if j < items else j)
        state.spent[READ] += VALUES_A_DEPTH
    state.outside[i] = outside_circle(within, layout.shape[i], x, y)
    state.spent[READ] += layout.shape.size


@helper
def _list(state, i, j):
    """Add a pair to the list if it is not in it."""
    if not state.listed[i, j]:
        state.listed[i, j] = True
        count = state.progress[PAIRS]
        state.pairs[count, 0], state.pairs[count, 1] = i, j
        state.progress[PAIRS] = count + 1


@helper
def _find_near(fields, layout, state, i, x, y, z, reach):
    """Write the fields that item i may be in within a reach of a position, and their weights; return their number."""
    count, a = 0, layout.shape[i]
    width = 2.0 * fields.step
    for j in range(layout.shape.size):
        b = layout.shape[j]
        if j == i or fields.first[a, b] < 0 or not _together(layout, i, j):
            continue
        origin, position, cells = fields.origin[a, b], layout.position[j], fields.cells[a, b]
        u, v, w = x - position[0] - origin[0], y - position[1] - origin[1], z - position[2] - origin[2]
        if (
            -reach <= u <= width * cells[0] + reach
            and -reach <= v <= width * cells[1] + reach
            and -reach <= w <= width * cells[2] + reach
        ):
            near, frame = state.near[count], state.frame[count]
            near[0], near[1] = fields.first[a, b], fields.stride[a, b]
            near[2], near[3], near[4] = cells[0], cells[1], cells[2]
            frame[0], frame[1], frame[2] = (
                position[0] + origin[0],
                position[1] + origin[1],
                position[2] + origin[2],
            )
            frame[3] = state.weight[i, j] * fields.scale
            count += 1
    return count


@helper
def _cost(fields, within, layout, state, i, count, x, y, z, limit):
    """Return the weighted overlap of item i at a position with the items near it, or any value above the limit."""
    total, scale = 0.0, 1.0 / fields.step
    if within.radius > 0.0:
        total = state.outside_weight[i] * outside_circle(within, layout.shape[i], x, y)
    for k in range(count):
        if total >= limit:
            break
        near, frame = state.near[k], state.frame[k]
        u, v, w = (x - frame[0]) * scale, (y - frame[1]) * scale, (z - frame[2]) * scale
        total += frame[3] * depth_between(fields.values, near, u, v, w)
        state.spent[READ] += VALUES_A_DEPTH
    return total


@helper
def _normal(random):
    return np.sqrt(-2.0 * np.log(1.0 - uniform(random))) * np.cos(2.0 * np.pi * uniform(random))


@helper
def _descend(fields, within, layout, rules, state, i, x, y, z, step):
    """Return a position near (x, y, z) of less weighted overlap, and that overlap.

    The descent goes along random directions, three of four parallel to an axis, with a step that adapts.
    """
    a, reach = layout.shape[i], 4.0 * step
    lo, hi = within.lo[a], within.hi[a]
    x0, y0, z0 = x, y, z
    count = _find_near(fields, layout, state, i, x, y, z, reach)
    cost = _cost(fields, within, layout, state, i, count, x, y, z, np.inf)
    failures = 0
    while step > rules.finest and cost > NEGLIGIBLE:
        axis = int(uniform(state.random) * 4.0)
        dx, dy, dz = 1.0 * (axis == 0), 1.0 * (axis == 1), 1.0 * (axis == 2)
        if axis == 3:
            dx, dy, dz = _normal(state.random), _normal(state.random), _normal(state.random)
            length = np.sqrt(dx * dx + dy * dy + dz * dz) + 1e-12
            dx, dy, dz = dx / length, dy / length, dz / length
        sign = step if uniform(state.random) < 0.5 else -step
        failures += 1
        for _ in range(2):
            u = clamped(x + sign * dx, x0, reach, lo[0], hi[0])
            v = clamped(y + sign * dy, y0, reach, lo[1], hi[1])
            w = clamped(z + sign * dz, z0, reach, lo[2], hi[2])
            sign = -sign
            if u != x or v != y or w != z:
                found = _cost(fields, within, layout, state, i, count, u, v, w, cost)
                if found < cost:
                    cost, x, y, z = found, u, v, w
                    step *= LONGER
                    failures = 0
                    break
        if failures >= TRIES:
            step *= SHORTER
            failures = 0
    return x, y, z, cost


@helper
def _scan(fields, within, layout, rules, state, i, best):
    """Return the best of a position, as (x, y, z, cost), and of those that a scan with the present shape finds."""
    a, spacing = layout.shape[i], 2.0 * fields.step
    lo, hi = within.lo[a], within.hi[a]
    if hi[0] < lo[0] or hi[1] < lo[1] or hi[2] < lo[2]:
        return best
    gx, gy, gz = (
        int((hi[0] - lo[0]) / spacing) + 1,
        int((hi[1] - lo[1]) / spacing) + 1,
        int((hi[2] - lo[2]) / spacing) + 1,
    )
    x = lo[0] + uniform(state.random) * (hi[0] - lo[0] - (gx - 1) * spacing)
    y = lo[1] + uniform(state.random) * (hi[1] - lo[1] - (gy - 1) * spacing)
    z = lo[2] + uniform(state.random) * (hi[2] - lo[2] - (gz - 1) * spacing)
    grid, start = (gx, gy, gz), (x, y, z)
    if gx * gy * gz > state.sums.size:
        return best
    weights = state.weight, state.outside_weight[i]
    read = add_overlaps(fields, within, layout, weights, i, 0, start, grid, state.sums)
    state.spent[READ] += read + gx * gy * gz
    state.spent[SCANS] += 1
    for k in range(best_cells(state.sums, grid, state.cell, state.value)):
        if best[3] <= NEGLIGIBLE or state.value[k] > 4.0 * best[3] + 1.0:
            break
        cell = state.cell[k]
        u, v, w = x + cell // (gy * gz) * spacing, y + cell // gz % gy * spacing, z + cell % gz * spacing
        found = _descend(fields, within, layout, rules, state, i, u, v, w, spacing)
        if found[3] < best[3]:
            best = found
    return best


@helper
def _move(fields, within, layout, rules, state, i):
    """Move an item to the position, among shapes and builds as well, of least weighted overlap that is found."""
    state.spent[MOVES] += 1
    x, y, z = layout.position[i]
    best = _descend(fields, within, layout, rules, state, i, x, y, z, fields.step)
    shape, build = layout.shape[i], layout.build[i]
    best_shape, best_build = shape, build
    if best[3] > NEGLIGIBLE and uniform(state.random) < rules.scan_chance:
        best = _scan(fields, within, layout, rules, state, i, best)
        for attempt in range(2):
            if best[3] <= NEGLIGIBLE:
                break
            layout.shape[i] = rules.first[i] + int(uniform(state.random) * (rules.end[i] - rules.first[i]))
            layout.build[i] = build
            if attempt == 1:
                layout.build[i] = int(uniform(state.random) * rules.builds)
            if layout.shape[i] == shape and layout.build[i] == build:
                continue
            found = _scan(fields, within, layout, rules, state, i, best)
            if found[3] < best[3]:
                best, best_shape, best_build = found, layout.shape[i], layout.build[i]
    layout.shape[i], layout.build[i] = best_shape, best_build
    layout.position[i, 0], layout.position[i, 1], layout.position[i, 2] = best[0], best[1], best[2]


@helper
def _weighted(state, i):
    """Return the weighted overlap of an item."""
    total = state.outside[i] * state.outside_weight[i]
    if state.touching[i] > 0:
        for j in range(state.overlap.shape[1]):
            total += state.overlap[i, j] * state.weight[i, j]
    return total


@helper
def _totals(state):
    """Return the total overlap and the deepest one, in which lengths outside the circle count."""
    total, deepest = 0.0, 0.0
    for i in range(state.outside.size):
        total += state.outside[i]
        deepest = max(deepest, state.outside[i])
    for k in range(state.progress[PAIRS]):
        overlap = state.overlap[state.pairs[k, 0], state.pairs[k, 1]]
        total += overlap
        deepest = max(deepest, overlap)
    return total, deepest


@helper
def _raise_weights(state, deepest):
    """Raise the weights of pairs that overlap and lower the others; pairs of weight 1 leave the list."""
    items = state.outside.size
    for i in range(items):
        state.outside_weight[i] = new_weight(state.outside_weight[i], state.outside[i], deepest, GROWTH)
    kept = 0
    for k in range(state.progress[PAIRS]):
        i, j = state.pairs[k, 0], state.pairs[k, 1]
        weight = new_weight(state.weight[i, j], state.overlap[i, j], deepest, GROWTH)
        state.weight[i, j] = weight
        if j < items:
            state.weight[j, i] = weight
        state.listed[i, j] = weight > 1.0 or state.overlap[i, j] > 0.0
        if state.listed[i, j]:
            state.pairs[kept, 0], state.pairs[kept, 1] = i, j
            kept += 1
    state.progress[PAIRS] = kept


@helper
def _copy(source, target):
    for i in range(source.shape.size):
        target.shape[i], target.build[i] = source.shape[i], source.build[i]
        for axis in range(3):
            target.position[i, axis] = source.position[i, axis]


@helper
def _begin(fields, within, layout, best, items, state):
    """Compute all overlaps; the layout is the best one so far."""
    for i in range(items):
        _update_overlaps(fields, within, layout, items, state, i)
        state.order[i] = i
    state.progress[NEXT] = 0
    state.least[0] = _totals(state)[0]
    _copy(layout, best)


@helper
def _shuffle(state, items):
    for k in range(items - 1, 0, -1):
        other = int(uniform(state.random) * (k + 1))
        state.order[k], state.order[other] = state.order[other], state.order[k]


@njit(cache=True, nogil=True, _nrt=False)
def separate(
    fields: NoFitFields,
    within: PositionRange,
    rules: MoveRules,
    layout: ShapeLayout,
    best: ShapeLayout,
    state: SeparationState,
    rounds: int,
    work: int,
) -> int:
    """Move items for some rounds, and write the layout of least total overlap; return the number of finished rounds.

    Parameters
    ----------
    layout
        Items, then obstacles, which stay; modified.
    best
        The layout of least total overlap so far, written.
    state
        Overlaps, weights and the place in a round, kept from call to call; modified.
    work
        Field values read after which the call ends, within a round too; the next call goes on from there.
    """
    items = rules.first.size
    last = state.spent[READ] + work
    if state.progress[NEXT] < 0:
        _begin(fields, within, layout, best, items, state)
    done = 0
    while done < rounds and state.least[0] > rules.enough and state.spent[READ] < last:
        if state.progress[NEXT] == 0:
            _shuffle(state, items)
        while state.progress[NEXT] < items and state.spent[READ] < last:
            i = state.order[state.progress[NEXT]]
            state.progress[NEXT] += 1
            if _weighted(state, i) > rules.enough / items:
                _move(fields, within, layout, rules, state, i)
                _update_overlaps(fields, within, layout, items, state, i)
        if state.progress[NEXT] < items:
            break
        state.progress[NEXT] = 0
        total, deepest = _totals(state)
        state.spent[ROUNDS] += 1
        done += 1
        if total < state.least[0]:
            state.least[0] = total
            _copy(layout, best)
        _raise_weights(state, max(deepest, 1e-12))
    return done
