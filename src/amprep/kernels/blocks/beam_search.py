"""Beam search over blocks, compiled: each state's worth is what a greedy completion makes of it.

After Araya and Riff 2014 (doi:10.1016/j.cor.2013.09.003), with the choice of blocks of Araya, Guerrero and
Nunez 2017 (doi:10.1016/j.cor.2017.01.002).
"""

import numpy as np
from numba import njit

from amprep.kernels.blocks.making import MOST_KINDS
from amprep.kernels.blocks.maximal_spaces import (
    anchor,
    contact,
    cut,
    measure_reach,
    nearest,
    neighbours,
    put,
    sift,
)
from amprep.kernels.blocks.records import MOST_SMALL
from amprep.kernels.boxes.places import helper

SPACES, PLACED, ALIVE, SMALL = 0, 1, 2, 3
"""Places in the counts of a state."""

STOP, WORK, LIMIT, LENGTH, MET, MORE = 0, 1, 2, 3, 4, 5
"""Places in the control: told to stop; work done and allowed; blocks in the best, work done when it was found;
whether a wider beam might find more."""

TRIAL, FIRST = 0, 1
"""Rows of the states: what is being completed, the beam."""

PRUNE = 3
"""Blocks placed before those that no longer fit are sorted out."""


@helper
def _copy(states, source, target):
    """Copy a state without its reach and living blocks."""
    for s in range(states.counts[source, SPACES]):
        for c in range(8):
            states.spaces[target, s, c] = states.spaces[source, s, c]
    for p in range(states.counts[source, PLACED]):
        for c in range(7):
            states.placed[target, p, c] = states.placed[source, p, c]
    for k in range(states.stock.shape[1]):
        states.stock[target, k] = states.stock[source, k]
    for k in range(states.counts[source, SMALL]):
        for a in range(3):
            states.small[target, k, a] = states.small[source, k, a]
    for c in range(4):
        states.counts[target, c] = states.counts[source, c]
    states.value[target] = states.value[source]


@helper
def _enough(kind, number, b, stock):
    """Whether there are enough boxes for the block."""
    for m in range(MOST_KINDS):
        if number[b, m] == 0:
            return True
        if number[b, m] > stock[kind[b, m]]:
            return False
    return True


@helper
def _choose(states, row, parent, alive, living, s, blocks, room, scratch, most, control):
    """Write the best blocks for a space, at most `most`, best first; return their number.

    The merit is value, times the share of the space that the block and whatever fits in line with it can use,
    times a power of the share of its surface that touches, over a power of its number of boxes.
    """
    spaces, stock, size, reach = states.spaces[row], states.stock[row], blocks.size, states.reach[parent]
    found, threshold, close = 0, 0.0, -1
    x, y, z = spaces[s, 3] - spaces[s, 0], spaces[s, 4] - spaces[s, 1], spaces[s, 5] - spaces[s, 2]
    shift, margin = room.shift, room.margin
    control[WORK] += living
    for k in range(living):
        b = alive[k]
        merit = blocks.base[b]
        if merit <= threshold:
            control[WORK] -= living - k
            break
        size_x, size_y, size_z = size[b, 0], size[b, 1], size[b, 2]
        over_x, over_y, over_z = x - size_x, y - size_y, z - size_z
        if over_x < 0 or over_y < 0 or over_z < 0:
            continue
        side_x, side_y, side_z = float(size_y) * size_z, float(size_x) * size_z, float(size_x) * size_y
        half = side_x + side_y + side_z
        # only the corner's faces, and those that are as far as the space's, can touch anything
        touched = half + (side_x if over_x <= margin[0] else 0.0) + (side_y if over_y <= margin[1] else 0.0)
        touched = (touched + (side_z if over_z <= margin[2] else 0.0)) / (2.0 * half)
        for _ in range(room.power):
            merit *= touched
        if merit <= threshold:
            continue
        used = float(size_x + (reach[0, over_x >> shift] << shift)) / x
        used *= float(size_y + (reach[1, over_y >> shift] << shift)) / y
        if not room.flat:
            used *= float(size_z + (reach[2, over_z >> shift] << shift)) / z
        merit *= used
        if merit <= threshold or not _enough(blocks.kind, blocks.number, b, stock):
            continue
        if room.power > 0:
            if close < 0:
                count = states.counts[row, PLACED]
                close = neighbours(spaces, s, states.placed[row], count, margin, scratch.near)
                control[WORK] += count
            put(spaces, s, size, b, scratch.box)
            control[WORK] += 6 * close
            touched = contact(scratch.box, room.box, states.placed[row], scratch.near, close, margin)
            merit = blocks.base[b] * used
            for _ in range(room.power):
                merit *= touched
            if merit <= threshold:
                continue
        at = found if found < most else most - 1
        found = min(found + 1, most)
        while at > 0 and scratch.merit[at - 1] < merit:
            scratch.merit[at], scratch.block[at] = scratch.merit[at - 1], scratch.block[at - 1]
            at -= 1
        scratch.merit[at], scratch.block[at] = merit, b
        if found == most:
            threshold = scratch.merit[most - 1]
    return found


@helper
def _place(states, row, s, b, blocks, room, scratch, control):
    """Place a block at the corner of a space (the row of the states is modified in place)."""
    box = scratch.box
    put(states.spaces[row], s, blocks.size, b, box)
    at = states.counts[row, PLACED]
    for c in range(6):
        states.placed[row, at, c] = box[c]
    states.placed[row, at, 6] = b
    states.counts[row, PLACED] += 1
    for m in range(MOST_KINDS):
        states.stock[row, blocks.kind[b, m]] -= blocks.number[b, m]
    states.value[row] += blocks.value[b]
    count = states.counts[row, SPACES]
    control[WORK] += 4 * count
    small, number = states.small[row], states.counts[row, SMALL]
    states.counts[row, SPACES] = cut(
        states.spaces[row], count, box, room.box, small, number, room.flat, scratch.fresh, scratch.touching
    )


@helper
def _drop(states, row, s):
    """Remove a space in which nothing fits."""
    last = states.counts[row, SPACES] - 1
    for c in range(8):
        states.spaces[row, s, c] = states.spaces[row, last, c]
    states.counts[row, SPACES] = last


@helper
def _find_small(states, row, blocks):
    """Write the smallest boxes in stock: every other is at least as long as one of them along each axis."""
    small, number = states.small[row], 0
    for k in range(blocks.single.size):
        b = blocks.single[k]
        if states.stock[row, blocks.kind[b, 0]] == 0:
            continue
        covered = False
        for i in range(number):
            inside = True
            for a in range(3):
                inside = inside and small[i, a] <= blocks.size[b, a]
            covered = covered or inside
        if covered:
            continue
        if number < MOST_SMALL:
            for a in range(3):
                small[number, a] = blocks.size[b, a]
            number += 1
        else:
            for a in range(3):
                small[number - 1, a] = min(small[number - 1, a], blocks.size[b, a])
    states.counts[row, SMALL] = number


@helper
def _prune(states, source, living, row, blocks, target):
    """Sort out spaces of no use, and write the blocks that may still be placed; return their number."""
    _find_small(states, row, blocks)
    states.counts[row, SPACES] = sift(
        states.spaces[row], states.counts[row, SPACES], states.small[row], states.counts[row, SMALL]
    )
    spaces, x, y, z = states.spaces, 0, 0, 0
    for s in range(states.counts[row, SPACES]):
        x = max(x, spaces[row, s, 3] - spaces[row, s, 0])
        y = max(y, spaces[row, s, 4] - spaces[row, s, 1])
        z = max(z, spaces[row, s, 5] - spaces[row, s, 2])
    found = 0
    for k in range(living):
        b = source[k]
        if blocks.size[b, 0] > x or blocks.size[b, 1] > y or blocks.size[b, 2] > z:
            continue
        if _enough(blocks.kind, blocks.number, b, states.stock[row]):
            target[found] = b
            found += 1
    return found


@helper
def _complete(states, row, parent, one, blocks, room, scratch, control):
    """Fill the state by placing the best block in the nearest space until nothing fits."""
    steps, living = 0, states.counts[parent, ALIVE]
    alive, own = states.alive[parent], states.alive[row]
    while states.counts[row, SPACES] > 0 and control[STOP] == 0:
        if steps % PRUNE == PRUNE - 1:
            control[WORK] += living
            living = _prune(states, alive, living, row, blocks, own)
            alive = own
        s = nearest(states.spaces[row], states.counts[row, SPACES])
        if _choose(states, row, parent, alive, living, s, blocks, room, scratch, one, control):
            _place(states, row, s, scratch.block[0], blocks, room, scratch, control)
            steps += 1
        else:
            _drop(states, row, s)


@helper
def _expand(states, first, count, most, blocks, room, scratch, best, best_value, control):
    """Write the successors of each state of the beam with what they come to; return their number."""
    # a constant as an argument would make the compiler do it all twice
    trial, one = np.int64(TRIAL), np.int64(1)
    found = 0
    for row in range(first, first + count):
        number, s = 0, 0
        while number == 0 and states.counts[row, SPACES] > 0:
            s = nearest(states.spaces[row], states.counts[row, SPACES])
            alive, living = states.alive[row], states.counts[row, ALIVE]
            number = _choose(states, row, row, alive, living, s, blocks, room, scratch, most, control)
            if number == 0:
                _drop(states, row, s)
        if number == most:
            control[MORE] = 1
        for j in range(number):
            scratch.child[found + j] = scratch.block[j]
        for _ in range(number):
            _copy(states, row, trial)
            _place(states, trial, s, scratch.child[found], blocks, room, scratch, control)
            _complete(states, trial, row, one, blocks, room, scratch, control)
            worth = states.value[trial]
            scratch.parent[found], scratch.space[found], scratch.worth[found] = row, s, worth
            found += 1
            if worth > best_value[0]:
                best_value[0] = worth
                control[LENGTH], control[MET] = states.counts[trial, PLACED], control[WORK]
                for p in range(control[LENGTH]):
                    for c in range(7):
                        best[p, c] = states.placed[trial, p, c]
            if control[WORK] > control[LIMIT] or best_value[0] >= room.goal:
                control[STOP] = 1
            if control[STOP]:
                return found
    return found


@helper
def _start(states, row, standing, columns, blocks, room, scratch):
    """Write the spaces beside what stands into a state; from `columns` on it stands alone when flat."""
    spaces, count, kept = states.spaces[row], np.int64(1), 0
    _find_small(states, row, blocks)
    small, number = states.small[row], states.counts[row, SMALL]
    for c in range(6):
        spaces[0, c] = room.box[c]
    for j in range(standing.shape[0]):
        column = room.flat and j >= columns
        count = cut(
            spaces, count, standing[j], room.box, small, number, column, scratch.fresh, scratch.touching
        )
        for c in range(6):
            states.placed[row, j, c] = standing[j, c]
        states.placed[row, j, 6] = -1
    for s in range(count):
        if not (room.flat and spaces[s, 2] > room.box[2]):
            for c in range(6):
                spaces[kept, c] = spaces[s, c]
            anchor(spaces[kept], room.box, room.flat)
            kept += 1
    states.counts[row, SPACES], states.counts[row, PLACED] = kept, standing.shape[0]


@helper
def _next(worth, found, last):
    """Return the successor of greatest worth below `last`, -1 when there is none."""
    chosen = -1
    for k in range(found):
        if worth[k] < last and (chosen < 0 or worth[k] > worth[chosen]):
            chosen = k
    return chosen


@njit(cache=True, nogil=True)
def search(width, standing, columns, states, blocks, room, scratch, best, best_value, control):
    """Search with a beam of `width` states and as many successors of each.

    Of successors with the same worth one is kept: most often they are the same but for the order.

    Parameters
    ----------
    standing, columns
        ``(m, 6)`` boxes in the way; from number `columns` on nothing may lie above or below them when flat.
    states
        At least ``2 * width + 1`` rows; row `FIRST` holds the stock, the living blocks and their number.
    best, best_value, control
        ``(p, 7)``, ``(1,)`` and ``(6,)``: the best placed boxes, their value, see `STOP`; modified in place.
    """
    control[MORE] = 0
    first, other, count = np.int64(FIRST), FIRST + width, np.int64(1)
    _start(states, first, standing, columns, blocks, room, scratch)
    measure_reach(states.reach[first], scratch.words, room.sides, room.starts, states.stock[first])
    while count > 0:
        found = _expand(states, first, count, width, blocks, room, scratch, best, best_value, control)
        if control[STOP]:
            return
        count, last = np.int64(0), np.inf
        while True:
            k = _next(scratch.worth, found, last)
            if k < 0:
                break
            if count == width:
                control[MORE] = 1
                break
            last = scratch.worth[k]
            parent, row = scratch.parent[k], other + count
            _copy(states, parent, row)
            _place(states, row, scratch.space[k], scratch.child[k], blocks, room, scratch, control)
            living = states.counts[parent, ALIVE]
            control[WORK] += living
            living = _prune(states, states.alive[parent], living, row, blocks, states.alive[row])
            states.counts[row, ALIVE] = living
            measure_reach(states.reach[row], scratch.words, room.sides, room.starts, states.stock[row])
            count += 1
        first, other = other, first
