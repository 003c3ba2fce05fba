"""Guided separation on plates: overlapping items move, one at a time, to the position of least weighted overlap."""

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
from amprep.kernels.plates.fields import depth_at, field_size, oriented
from amprep.kernels.plates.records import (
    NONE,
    FieldCache,
    PlateLayout,
    PlateShapes,
    PlateState,
    SampledOutlines,
)
from amprep.kernels.plates.scan import add_overlaps, best_cells, scan_size
from amprep.kernels.random_numbers import uniform

# Strategy. As in `kernels.no_fit.separate`, in the plane and on several plates at once. Overlaps are allowed and
# weighted. A round visits the overlapping items in random order. An item first descends from its position; where an
# overlap remains, it may scan its plate in its present shape, in another one, and another plate, and descends from the
# best cells. After each round the weights of pairs that still overlap grow, in proportion to their depth, and the
# others decay towards 1 (guided local search: Voudouris, Tsang 1999, doi:10.1016/S0377-2217(98)00099-X; Umetani et al.
# 2009, doi:10.1111/j.1475-3995.2009.00707.x).

GROWTH = WeightGrowth(least=1.03, most=1.15, decay=0.97)

OTHERS = 12
"""Number of other shapes and plates that a move scans."""


@helper
def _together(layout, i, j):
    """Tell whether an item and another or an obstacle are on the same plate."""
    return layout.plate[i] == layout.plate[j] or layout.plate[j] == EVERYWHERE


@helper
def _update_overlaps(outlines, cache, shapes, layout, items, state, i):
    """Compute the overlaps of item i with all others anew."""
    for j in range(layout.shape.size):
        depth = 0.0
        if j != i and _together(layout, i, j):
            x = layout.position[i, 0] - layout.position[j, 0]
            y = layout.position[i, 1] - layout.position[j, 1]
            depth = depth_at(outlines, cache, shapes, layout.shape[i], layout.shape[j], x, y, state.spent)
        state.overlap[i, j] = depth
        if j < items:
            state.overlap[j, i] = depth
    state.spent[READ] += VALUES_A_DEPTH * layout.shape.size


@helper
def _find_near(outlines, cache, shapes, layout, i, x, y, reach, near):
    """Write the items and obstacles that item i may overlap within a reach of a position; return their number."""
    count = 0
    for j in range(layout.shape.size):
        if j == i or not _together(layout, i, j):
            continue
        a, b, quarter, turns = oriented(shapes, layout.shape[i], layout.shape[j])
        if cache.first[a, b, quarter] == NONE:
            continue
        cx, cy = field_size(outlines, a, b, quarter)
        if turns & 1:
            cx, cy = cy, cx
        dx, dy = x - layout.position[j, 0], y - layout.position[j, 1]
        if abs(dx) <= cx * outlines.step + reach and abs(dy) <= cy * outlines.step + reach:
            near[count] = j
            count += 1
    return count


@helper
def _cost(outlines, cache, shapes, layout, state, i, count, x, y, limit):
    """Return the weighted overlap of item i at a position with the items near it, or any value above the limit."""
    total = 0.0
    for k in range(count):
        if total >= limit:
            break
        j = state.near[k]
        dx, dy = x - layout.position[j, 0], y - layout.position[j, 1]
        depth = depth_at(outlines, cache, shapes, layout.shape[i], layout.shape[j], dx, dy, state.spent)
        total += state.weight[i, j] * depth
        state.spent[READ] += VALUES_A_DEPTH
    return total


@helper
def _descend(outlines, cache, shapes, layout, rules, state, i, x, y, step):
    """Return a position near (x, y) of less weighted overlap, and that overlap.

    The descent goes along random directions, half of them parallel to an axis, with a step that adapts.
    """
    shape, reach = layout.shape[i], 4.0 * step
    lo, hi = shapes.lo[shape], shapes.hi[shape]
    x0, y0 = x, y
    count = _find_near(outlines, cache, shapes, layout, i, x, y, reach, state.near)
    cost = _cost(outlines, cache, shapes, layout, state, i, count, x, y, np.inf)
    failures = 0
    while step > rules.finest and cost > NEGLIGIBLE:
        kind = int(uniform(state.random) * 4.0)
        dx, dy = 1.0 * (kind == 0), 1.0 * (kind == 1)
        if kind > 1:
            angle = 2.0 * np.pi * uniform(state.random)
            dx, dy = np.cos(angle), np.sin(angle)
        sign = step if uniform(state.random) < 0.5 else -step
        failures += 1
        for _ in range(2):
            u = clamped(x + sign * dx, x0, reach, lo[0], hi[0])
            v = clamped(y + sign * dy, y0, reach, lo[1], hi[1])
            sign = -sign
            if u != x or v != y:
                found = _cost(outlines, cache, shapes, layout, state, i, count, u, v, cost)
                if found < cost:
                    cost, x, y = found, u, v
                    step *= LONGER
                    failures = 0
                    break
        if failures >= TRIES:
            step *= SHORTER
            failures = 0
    return x, y, cost


@helper
def _scan(outlines, cache, shapes, layout, rules, state, i, best):
    """Return the best of a position, as (x, y, cost), and of those that a scan in the present shape and plate finds."""
    shape = layout.shape[i]
    size = scan_size(outlines, shapes, shape)
    gx, gy = size
    if gx * gy == 0:
        return best
    lo, hi, step = shapes.lo[shape], shapes.hi[shape], outlines.step
    x = lo[0] + uniform(state.random) * (hi[0] - lo[0] - (gx - 1) * step)
    y = lo[1] + uniform(state.random) * (hi[1] - lo[1] - (gy - 1) * step)
    add_overlaps(outlines, cache, shapes, layout, i, (x, y), size, state)
    state.spent[READ] += 2 * gx * gy
    state.spent[SCANS] += 1
    for k in range(best_cells(state.sums, size, state.cell, state.value)):
        if best[2] <= NEGLIGIBLE or state.value[k] > 2.0 * best[2] + 0.5 * step:
            break
        u, v = x + state.cell[k] // gy * step, y + state.cell[k] % gy * step
        found = _descend(outlines, cache, shapes, layout, rules, state, i, u, v, step)
        if found[2] < best[2]:
            best = found
    return best


@helper
def _move(outlines, cache, shapes, layout, rules, state, i):
    """Move an item to the position, among shapes and plates as well, of least weighted overlap that is found."""
    state.spent[MOVES] += 1
    x, y = layout.position[i]
    best = _descend(outlines, cache, shapes, layout, rules, state, i, x, y, outlines.step)
    shape, plate = layout.shape[i], layout.plate[i]
    best_shape, best_plate = shape, plate
    if best[2] > NEGLIGIBLE and uniform(state.random) < rules.scan_chance:
        best = _scan(outlines, cache, shapes, layout, rules, state, i, best)
        for attempt in range(OTHERS):
            if best[2] <= NEGLIGIBLE:
                break
            layout.shape[i] = rules.first[i] + int(uniform(state.random) * (rules.end[i] - rules.first[i]))
            layout.plate[i] = plate
            if attempt > 0:
                layout.plate[i] = int(uniform(state.random) * rules.builds)
            if layout.shape[i] == shape and layout.plate[i] == plate:
                continue
            found = _scan(outlines, cache, shapes, layout, rules, state, i, best)
            if found[2] < best[2]:
                best, best_shape, best_plate = found, layout.shape[i], layout.plate[i]
    layout.shape[i], layout.plate[i] = best_shape, best_plate
    layout.position[i, 0], layout.position[i, 1] = best[0], best[1]


@helper
def _weighted(state, i):
    """Return the weighted overlap of an item."""
    total = 0.0
    for j in range(state.overlap.shape[1]):
        total += state.overlap[i, j] * state.weight[i, j]
    return total


@helper
def _totals(items, state):
    """Return the total overlap and the deepest one."""
    total, deepest = 0.0, 0.0
    for i in range(items):
        for j in range(state.overlap.shape[1]):
            if j < i or j >= items:
                total += state.overlap[i, j]
                deepest = max(deepest, state.overlap[i, j])
    return total, deepest


@helper
def _raise_weights(items, state, deepest):
    """Raise the weights of pairs that overlap and lower the others."""
    for i in range(items):
        for j in range(state.overlap.shape[1]):
            if j < i or j >= items:
                weight = new_weight(state.weight[i, j], state.overlap[i, j], deepest, GROWTH)
                state.weight[i, j] = weight
                if j < i:
                    state.weight[j, i] = weight


@helper
def _copy(source, target):
    for i in range(source.shape.size):
        target.shape[i], target.plate[i] = source.shape[i], source.plate[i]
        target.position[i, 0], target.position[i, 1] = source.position[i, 0], source.position[i, 1]


@njit(cache=True, nogil=True, _nrt=False)
def separate_plates(
    outlines: SampledOutlines,
    cache: FieldCache,
    shapes: PlateShapes,
    rules: MoveRules,
    layout: PlateLayout,
    best: PlateLayout,
    state: PlateState,
    rounds: int,
) -> float:
    """Move items for some rounds; return the total overlap (mm) of the best layout.

    Parameters
    ----------
    cache
        Fields, computed when they are needed; modified.
    layout
        Items, then obstacles, which stay; modified.
    best
        The layout of least total overlap, written.
    state
        Weights, kept from call to call; modified.
    """
    items = rules.first.size
    for i in range(items):
        _update_overlaps(outlines, cache, shapes, layout, items, state, i)
        state.order[i] = i
    least, deepest = _totals(items, state)
    _copy(layout, best)
    for _ in range(rounds):
        if least <= rules.enough:
            break
        for k in range(items - 1, 0, -1):
            other = int(uniform(state.random) * (k + 1))
            state.order[k], state.order[other] = state.order[other], state.order[k]
        for k in range(items):
            i = state.order[k]
            if _weighted(state, i) > rules.enough / items:
                _move(outlines, cache, shapes, layout, rules, state, i)
                _update_overlaps(outlines, cache, shapes, layout, items, state, i)
        total, deepest = _totals(items, state)
        state.spent[ROUNDS] += 1
        if total < least:
            least = total
            _copy(layout, best)
        _raise_weights(items, state, max(deepest, 1e-12))
    return least
