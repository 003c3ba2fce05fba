"""Beam search over blocks: each state is valued by the packing that a greedy completion makes of it.

After Araya and Riff 2014 (doi:10.1016/j.cor.2013.09.003), with the choice of blocks of Araya, Guerrero and
Nunez 2017 (doi:10.1016/j.cor.2017.01.002).
"""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.blocks.choose import choose, is_available
from amprep.kernels.blocks.maximal_spaces import anchor, cut, drop_useless, nearest, put, usable_lengths
from amprep.kernels.blocks.records import (
    CANDIDATES,
    FOUND_AT,
    LENGTH,
    LIMIT,
    MAX_ITEM_TYPES,
    MAX_SMALLEST,
    MORE,
    PLACED,
    SMALLEST,
    SPACES,
    STOP,
    WORK,
    BeamSearch,
    Blocks,
    States,
)
from amprep.kernels.helper import helper

TRIAL, FIRST = 0, 1
"""Rows of the states: the state being completed, and the start of the beam."""

PRUNE_INTERVAL = 3
"""Number of blocks placed between two removals of the blocks that no longer fit."""

# Strategy. A state is a container with some blocks placed, its maximal empty spaces and the boxes left. One
# move places a block at the corner of the space nearest to a corner of the container. Each state of the beam
# is expanded by the `width` best blocks for its space; every successor is completed greedily, one best block
# after another, and the value of the complete packing is the value of the successor. The best completion seen
# is the answer, so the search has one from its first step on. The `width` best successors of different values
# are the next beam; equal values most often mean the same blocks in another order.
#
# The beam and its successors alternate between two ranges of rows, so a state is copied once per generation.


@helper
def _copy(states: States, source: int, target: int) -> None:
    """Copy a state without its usable lengths and candidates."""
    for s in range(states.counts[source, SPACES]):
        for c in range(8):
            states.spaces[target, s, c] = states.spaces[source, s, c]
    for p in range(states.counts[source, PLACED]):
        for c in range(7):
            states.placed[target, p, c] = states.placed[source, p, c]
    for k in range(states.demand.shape[1]):
        states.demand[target, k] = states.demand[source, k]
    for k in range(states.counts[source, SMALLEST]):
        for a in range(3):
            states.smallest[target, k, a] = states.smallest[source, k, a]
    for c in range(4):
        states.counts[target, c] = states.counts[source, c]
    states.value[target] = states.value[source]


@helper
def _place(search: BeamSearch, row: int, s: int, b: int) -> None:
    """Place block b at the corner of space s of a state (the row of the states is modified in place)."""
    blocks, states, box = search.blocks, search.states, search.scratch.box
    put(states.spaces[row], s, blocks.size, b, box)
    at = states.counts[row, PLACED]
    for c in range(6):
        states.placed[row, at, c] = box[c]
    states.placed[row, at, 6] = b
    states.counts[row, PLACED] += 1
    for m in range(MAX_ITEM_TYPES):
        states.demand[row, blocks.item_type[b, m]] -= blocks.number[b, m]
    states.value[row] += blocks.value[b]
    search.control[WORK] += 4 * states.counts[row, SPACES]
    _cut(search, row, box, search.rules.flat)


@helper
def _cut(search: BeamSearch, row: int, box: Int64s, flat: bool) -> None:
    """Remove a box from the free space of a state."""
    states, scratch = search.states, search.scratch
    states.counts[row, SPACES] = cut(
        states.spaces[row],
        states.counts[row, SPACES],
        box,
        search.rules.container,
        states.smallest[row],
        states.counts[row, SMALLEST],
        flat,
        scratch.fresh,
        scratch.touching,
    )


@helper
def _drop(states: States, row: int, s: int) -> None:
    """Remove a space in which no block fits."""
    last = states.counts[row, SPACES] - 1
    for c in range(8):
        states.spaces[row, s, c] = states.spaces[row, last, c]
    states.counts[row, SPACES] = last


@helper
def _find_smallest(states: States, row: int, blocks: Blocks) -> None:
    """Write the smallest boxes left: every other box is at least as long as one of them along each axis.

    If there are more than `MAX_SMALLEST`, the last one takes the least side along each axis of the rest.
    """
    smallest, number = states.smallest[row], 0
    for k in range(blocks.single.size):
        b = blocks.single[k]
        if states.demand[row, blocks.item_type[b, 0]] == 0:
            continue
        covered = False
        for i in range(number):
            inside = True
            for a in range(3):
                inside = inside and smallest[i, a] <= blocks.size[b, a]
            covered = covered or inside
        if covered:
            continue
        if number < MAX_SMALLEST:
            for a in range(3):
                smallest[number, a] = blocks.size[b, a]
            number += 1
        else:
            for a in range(3):
                smallest[number - 1, a] = min(smallest[number - 1, a], blocks.size[b, a])
    states.counts[row, SMALLEST] = number


@helper
def _prune(search: BeamSearch, row: int, source: Int32s, number: int, target: Int32s) -> int:
    """Remove useless spaces, and write the blocks that may still be placed; return their number.

    `target` may be `source`: a block is written at or before its own place.
    """
    blocks, states = search.blocks, search.states
    _find_smallest(states, row, blocks)
    states.counts[row, SPACES] = drop_useless(
        states.spaces[row], states.counts[row, SPACES], states.smallest[row], states.counts[row, SMALLEST]
    )
    spaces, x, y, z = states.spaces, 0, 0, 0
    for s in range(states.counts[row, SPACES]):
        x = max(x, spaces[row, s, 3] - spaces[row, s, 0])
        y = max(y, spaces[row, s, 4] - spaces[row, s, 1])
        z = max(z, spaces[row, s, 5] - spaces[row, s, 2])
    search.control[WORK] += number
    found = 0
    for k in range(number):
        b = source[k]
        if blocks.size[b, 0] > x or blocks.size[b, 1] > y or blocks.size[b, 2] > z:
            continue
        if is_available(blocks, b, states.demand[row]):
            target[found] = b
            found += 1
    return found


@helper
def _complete(search: BeamSearch, row: int, parent: int, one: int) -> None:
    """Place the best block in the nearest space until nothing fits; `one` is the number 1."""
    states = search.states
    steps, number = 0, states.counts[parent, CANDIDATES]
    candidates, own = states.candidates[parent], states.candidates[row]
    while states.counts[row, SPACES] > 0 and search.control[STOP] == 0:
        if steps % PRUNE_INTERVAL == PRUNE_INTERVAL - 1:
            number = _prune(search, row, candidates, number, own)
            candidates = own
        s = nearest(states.spaces[row], states.counts[row, SPACES])
        if choose(search, row, s, parent, candidates, number, one):
            _place(search, row, s, search.scratch.block[0])
            steps += 1
        else:
            _drop(states, row, s)


@helper
def _keep_best(search: BeamSearch, row: int) -> None:
    """Copy a complete state to the answer if it is better."""
    states, control = search.states, search.control
    if states.value[row] <= search.best_value[0]:
        return
    search.best_value[0] = states.value[row]
    control[LENGTH], control[FOUND_AT] = states.counts[row, PLACED], control[WORK]
    for p in range(control[LENGTH]):
        for c in range(7):
            search.best[p, c] = states.placed[row, p, c]


@helper
def _choose_first(search: BeamSearch, row: int, most: int) -> tuple[int, int]:
    """Choose the blocks for the nearest space in which any fits; return the space and their number."""
    states, number, s = search.states, 0, 0
    while number == 0 and states.counts[row, SPACES] > 0:
        s = nearest(states.spaces[row], states.counts[row, SPACES])
        number = choose(search, row, s, row, states.candidates[row], states.counts[row, CANDIDATES], most)
        if number == 0:
            _drop(states, row, s)
    return s, number


@helper
def _expand(search: BeamSearch, first: int, count: int, most: int) -> int:
    """Write the successors of the `count` states from row `first` with their values; return their number."""
    # literal integers would compile each helper a second time
    trial, one = np.int64(TRIAL), np.int64(1)
    states, scratch, control = search.states, search.scratch, search.control
    found = 0
    for row in range(first, first + count):
        s, number = _choose_first(search, row, most)
        if number == most:
            control[MORE] = 1
        for j in range(number):
            scratch.child[found + j] = scratch.block[j]
        for _ in range(number):
            _copy(states, row, trial)
            _place(search, trial, s, scratch.child[found])
            _complete(search, trial, row, one)
            scratch.parent[found], scratch.space[found] = row, s
            scratch.completed[found] = states.value[trial]
            found += 1
            _keep_best(search, trial)
            if control[WORK] > control[LIMIT] or search.best_value[0] >= search.rules.goal:
                control[STOP] = 1
            if control[STOP]:
                return found
    return found


@helper
def _start(search: BeamSearch, row: int, obstacles: Int64s, columns: int) -> None:
    """Write the empty spaces between the obstacles into a state; see `search` for `columns`."""
    states, rules = search.states, search.rules
    spaces, kept = states.spaces[row], 0
    _find_smallest(states, row, search.blocks)
    states.counts[row, SPACES] = 1
    for c in range(6):
        spaces[0, c] = rules.container[c]
    for j in range(obstacles.shape[0]):
        _cut(search, row, obstacles[j], rules.flat and j >= columns)
        for c in range(6):
            states.placed[row, j, c] = obstacles[j, c]
        states.placed[row, j, 6] = -1
    for s in range(states.counts[row, SPACES]):
        if not (rules.flat and spaces[s, 2] > rules.container[2]):
            for c in range(6):
                spaces[kept, c] = spaces[s, c]
            anchor(spaces[kept], rules.container, rules.flat)
            kept += 1
    states.counts[row, SPACES], states.counts[row, PLACED] = kept, obstacles.shape[0]


@helper
def _next(completed: Floats, found: int, last: float) -> int:
    """Return the successor with the greatest value below `last`; -1 if there is none."""
    chosen = -1
    for k in range(found):
        if completed[k] < last and (chosen < 0 or completed[k] > completed[chosen]):
            chosen = k
    return chosen


@njit(cache=True, nogil=True)
def run_search(search: BeamSearch, width: int, obstacles: Int64s, columns: int) -> None:
    """Run a beam search; the answer is in `best`, `best_value` and `control`.

    The search ends when no state has a successor, at a stop request, when the work is used up, or at the goal.

    Parameters
    ----------
    search
        At least ``2 * width + 1`` states. Row `FIRST` holds the demand, the value of the obstacles, and the
        candidates with their number. `best_value` holds the value to beat. All arrays except those of
        `blocks` and `rules` are modified in place.
    width
        Number of states in the beam, and of successors of each.
    obstacles
        ``(m, 6)`` corners of boxes already in the container.
    columns
        Number of the first obstacle above and below which nothing may be placed if `rules.flat`.
    """
    states, scratch, rules, control = search.states, search.scratch, search.rules, search.control
    control[MORE] = 0
    first, other, count = int(np.int64(FIRST)), int(FIRST + width), int(np.int64(1))
    _start(search, first, obstacles, columns)
    usable_lengths(states.usable[first], scratch.words, rules.sides, rules.starts, states.demand[first])
    while count > 0:
        found = _expand(search, first, count, width)
        if control[STOP]:
            return
        count, last = int(np.int64(0)), np.inf
        while True:
            k = _next(scratch.completed, found, last)
            if k < 0:
                break
            if count == width:
                control[MORE] = 1
                break
            last = scratch.completed[k]
            parent, row = scratch.parent[k], other + count
            _copy(states, parent, row)
            _place(search, row, scratch.space[k], scratch.child[k])
            number = states.counts[parent, CANDIDATES]
            number = _prune(search, row, states.candidates[parent], number, states.candidates[row])
            states.counts[row, CANDIDATES] = number
            usable_lengths(states.usable[row], scratch.words, rules.sides, rules.starts, states.demand[row])
            count += 1
        first, other = other, first
