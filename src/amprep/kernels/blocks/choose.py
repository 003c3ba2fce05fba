"""Choose the best blocks for a maximal space.

The score follows Araya, Guerrero and Nunez 2017 (doi:10.1016/j.cor.2017.01.002).
"""

from amprep.arrays import Int32s, Int64s
from amprep.kernels.blocks.maximal_spaces import neighbours, put, touching_fraction
from amprep.kernels.blocks.records import MAX_ITEM_TYPES, PLACED, WORK, BeamScratch, BeamSearch, Blocks
from amprep.kernels.helper import helper

# Strategy. A search spends nearly all its time here, scanning the blocks for one space. Three bounds keep
# the scan short. Blocks are sorted by an upper bound of their score, so the scan ends at the first block
# whose bound is not above the worst of the best found. The second bound counts the faces that can touch
# anything at all. The third uses precomputed lengths (`usable_lengths`) for the space that stays usable
# beside the block. Only a block that passes all three has its contact measured.


@helper
def is_available(blocks: Blocks, b: int, demand: Int64s) -> bool:
    """Return whether enough boxes are left for the block."""
    for m in range(MAX_ITEM_TYPES):
        if blocks.number[b, m] == 0:
            return True
        if blocks.number[b, m] > demand[blocks.item_type[b, m]]:
            return False
    return True


@helper
def _contact_bound(
    side_x: int, side_y: int, side_z: int, over: tuple[int, int, int], margin: Int64s
) -> float:
    """Return an upper bound of the touching fraction of a block.

    The three faces at the corner may touch. An opposite face may touch only if the space ends within the
    margin behind it; `over` is the length of the space beyond the block along each axis.
    """
    face_x, face_y, face_z = float(side_y) * side_z, float(side_x) * side_z, float(side_x) * side_y
    half = face_x + face_y + face_z
    touched = half + (face_x if over[0] <= margin[0] else 0.0) + (face_y if over[1] <= margin[1] else 0.0)
    return (touched + (face_z if over[2] <= margin[2] else 0.0)) / (2.0 * half)


@helper
def _insert(scratch: BeamScratch, found: int, most: int, score: float, b: int) -> int:
    """Insert a block into the list of at most `most` best ones; return the new length of the list."""
    at = found if found < most else most - 1
    while at > 0 and scratch.score[at - 1] < score:
        scratch.score[at], scratch.block[at] = scratch.score[at - 1], scratch.block[at - 1]
        at -= 1
    scratch.score[at], scratch.block[at] = score, b
    return min(found + 1, most)


@helper
def choose(
    search: BeamSearch, row: int, s: int, parent: int, candidates: Int32s, number: int, most: int
) -> int:
    """Write the best blocks for a space to the work arrays, best first; return their number.

    The score of a block is ``base_score * usable * touching ** power``. The usable fraction of the space is
    that of the block together with the longest rows of boxes that fit in line with it; the touching fraction
    is that of the block's surface.

    Parameters
    ----------
    row, s
        The state and its space.
    parent
        The state whose usable lengths are used; those of a state being completed are not computed.
    candidates, number
        The first `number` blocks of `candidates` are examined.
    most
        Largest number of blocks to write.
    """
    blocks, rules, states, scratch, control = (
        search.blocks,
        search.rules,
        search.states,
        search.scratch,
        search.control,
    )
    spaces, demand, size, usable = states.spaces[row], states.demand[row], blocks.size, states.usable[parent]
    placed, shift, margin = states.placed[row], rules.shift, rules.margin
    found, threshold, close = 0, 0.0, -1
    x, y, z = spaces[s, 3] - spaces[s, 0], spaces[s, 4] - spaces[s, 1], spaces[s, 5] - spaces[s, 2]
    control[WORK] += number
    for k in range(number):
        b = candidates[k]
        score = blocks.base_score[b]
        if score <= threshold:
            control[WORK] -= number - k
            break
        over_x, over_y, over_z = x - size[b, 0], y - size[b, 1], z - size[b, 2]
        if over_x < 0 or over_y < 0 or over_z < 0:
            continue
        touching = _contact_bound(size[b, 0], size[b, 1], size[b, 2], (over_x, over_y, over_z), margin)
        for _ in range(rules.power):
            score *= touching
        if score <= threshold:
            continue
        used = float(size[b, 0] + (usable[0, over_x >> shift] << shift)) / x
        used *= float(size[b, 1] + (usable[1, over_y >> shift] << shift)) / y
        if not rules.flat:
            used *= float(size[b, 2] + (usable[2, over_z >> shift] << shift)) / z
        score *= used
        if score <= threshold or not is_available(blocks, b, demand):
            continue
        if rules.power > 0:
            if close < 0:  # the neighbours are found once per space
                count = states.counts[row, PLACED]
                close = neighbours(spaces, s, placed, count, margin, scratch.near)
                control[WORK] += count
            put(spaces, s, size, b, scratch.box)
            control[WORK] += 6 * close
            touching = touching_fraction(scratch.box, rules.container, placed, scratch.near, close, margin)
            score = blocks.base_score[b] * used
            for _ in range(rules.power):
                score *= touching
            if score <= threshold:
                continue
        found = _insert(scratch, found, most, score, b)
        if found == most:
            threshold = scratch.score[most - 1]
    return found
