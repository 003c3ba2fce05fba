"""Maximal empty spaces: cut them by a placed box, choose the next one, and measure the contact of a box in it.

Lengths are whole numbers, so no decision depends on rounding. A space is a row ``x0, y0, z0, x1, y1, z1,
distance, corner``. ``corner`` is the corner of the space that is nearest to the same corner of the container
(bits 1, 2 and 4: at the far side in x, y and z), and ``distance`` is the Manhattan distance between the two.
"""

import numpy as np

from amprep.arrays import Int64s
from amprep.kernels.helper import helper

DISTANCE, CORNER = 6, 7
"""Columns of a space after the coordinates of its corners."""

# Strategy. The free volume of a container is kept as the set of all maximal boxes in it (Lai and Chan 1997,
# doi:10.1016/S0360-8352(96)00205-7). A placed box replaces every space that it overlaps by up to six new ones,
# one per face. A new space is not maximal if another space contains it. Two facts keep that test cheap. A new
# space lies beside one face of the box, so among the old spaces only those that touch the box can contain it;
# and among the new ones only those of the same face can. Spaces too small for any box left are dropped at
# once. With n spaces, m of them overlapping, the cut takes O(n + m (m + touching spaces)) steps.


@helper
def anchor(space: Int64s, container: Int64s, flat: bool) -> None:
    """Write the nearest corner and its distance into the space; when flat, only corners on the plate count."""
    distance, corner = 0, 0
    for a in range(3):
        near, far = space[a] - container[a], container[3 + a] - space[3 + a]
        if far < near and not (flat and a == 2):
            near = far
            corner |= 1 << a
        distance += near
    space[DISTANCE], space[CORNER] = distance, corner


@helper
def _is_within(one: Int64s, i: int, other: Int64s, j: int) -> bool:
    """Return whether space i of `one` is contained in space j of `other`."""
    inside = True
    for a in range(3):
        inside = inside and one[i, a] >= other[j, a] and one[i, 3 + a] <= other[j, 3 + a]
    return inside


@helper
def _holds_any(spaces: Int64s, s: int, smallest: Int64s, number: int) -> bool:
    """Return whether one of the first `number` smallest boxes fits the space."""
    x, y, z = spaces[s, 3] - spaces[s, 0], spaces[s, 4] - spaces[s, 1], spaces[s, 5] - spaces[s, 2]
    k = 0
    while k < number and (smallest[k, 0] > x or smallest[k, 1] > y or smallest[k, 2] > z):
        k += 1
    return k < number


@helper
def _copy_row(source: Int64s, i: int, target: Int64s, j: int, columns: int) -> None:
    for c in range(columns):
        target[j, c] = source[i, c]


@helper
def drop_useless(spaces: Int64s, count: int, smallest: Int64s, number: int) -> int:
    """Remove the spaces that hold none of the smallest boxes (in place); return the number of the others."""
    kept = 0
    for s in range(count):
        if _holds_any(spaces, s, smallest, number):
            if kept < s:
                _copy_row(spaces, s, spaces, kept, np.int64(8))
            kept += 1
    return kept


@helper
def _split_off(
    spaces: Int64s, count: int, box: Int64s, flat: bool, fresh: Int64s, touching: Int64s
) -> tuple[int, int, int]:
    """Move the spaces that the box overlaps to `fresh`; return the numbers kept, moved and touching.

    `touching` receives the numbers of the kept spaces that share a face plane with the box.
    """
    kept, moved, near = 0, 0, 0
    for s in range(count):
        apart, touches = False, False
        for a in range(3):
            if not (flat and a == 2):
                apart = apart or box[a] >= spaces[s, 3 + a] or box[3 + a] <= spaces[s, a]
                touches = touches or box[a] == spaces[s, 3 + a] or box[3 + a] == spaces[s, a]
        if not apart:
            _copy_row(spaces, s, fresh, moved, np.int64(6))
            moved += 1
            continue
        if kept < s:
            _copy_row(spaces, s, spaces, kept, np.int64(8))
        if touches:
            touching[near] = kept
            near += 1
        kept += 1
    return kept, moved, near


@helper
def _add_if_maximal(fresh: Int64s, first: int, new: int, spaces: Int64s, touching: Int64s, near: int) -> int:
    """Keep row `new` of `fresh` unless a space contains it; return the end of the rows kept.

    The rows from `first` to `new` lie beside the same face; those that the new row contains are removed.
    """
    inside, j = False, 0
    while not inside and j < near:
        inside = _is_within(fresh, new, spaces, touching[j])
        j += 1
    j = first
    while not inside and j < new:
        inside = _is_within(fresh, new, fresh, j)
        if not inside and _is_within(fresh, j, fresh, new):
            new -= 1
            _copy_row(fresh, new, fresh, j, np.int64(6))
            _copy_row(fresh, new + 1, fresh, new, np.int64(6))
        else:
            j += 1
    return new if inside else new + 1


@helper
def cut(
    spaces: Int64s,
    count: int,
    box: Int64s,
    container: Int64s,
    smallest: Int64s,
    number: int,
    flat: bool,
    fresh: Int64s,
    touching: Int64s,
) -> int:
    """Remove a box from the free space (in place); return the new number of spaces.

    Parameters
    ----------
    spaces, count
        ``(s, 8)`` maximal spaces, of which the first `count` rows are in use.
    box, container
        ``(6,)`` corners.
    smallest, number
        ``(MAX_SMALLEST, 3)`` sides; a space that holds none of the first `number` of them is dropped.
    flat
        True if nothing may be placed above or below the box.
    fresh, touching
        ``(f, 8)`` and ``(s,)`` work arrays.
    """
    kept, moved, near = _split_off(spaces, count, box, flat, fresh, touching)
    for side in range(6):
        a = side % 3
        if flat and a == 2:
            continue
        new = moved
        for s in range(moved):
            left = box[a] - fresh[s, a] if side < 3 else fresh[s, 3 + a] - box[3 + a]
            if left <= 0:
                continue
            _copy_row(fresh, s, fresh, new, np.int64(6))
            if side < 3:
                fresh[new, 3 + a] = box[a]
            else:
                fresh[new, a] = box[3 + a]
            if _holds_any(fresh, new, smallest, number):
                new = _add_if_maximal(fresh, moved, new, spaces, touching, near)
        for s in range(moved, new):
            if kept < spaces.shape[0]:
                _copy_row(fresh, s, spaces, kept, np.int64(6))
                anchor(spaces[kept], container, flat)
                kept += 1
    return int(kept)


@helper
def nearest(spaces: Int64s, count: int) -> int:
    """Return the space nearest to a corner of the container; of equally near ones the largest."""
    best, best_volume = 0, -1.0
    for s in range(count):
        if spaces[s, DISTANCE] > spaces[best, DISTANCE]:
            continue
        volume = 1.0
        for a in range(3):
            volume *= spaces[s, 3 + a] - spaces[s, a]
        if spaces[s, DISTANCE] < spaces[best, DISTANCE] or volume > best_volume:
            best, best_volume = s, volume
    return best


@helper
def put(spaces: Int64s, s: int, size: Int64s, b: int, box: Int64s) -> None:
    """Write the corners of block b, placed at the corner of space s, into `box`."""
    corner = spaces[s, CORNER]
    for a in range(3):
        if corner & (1 << a):
            box[a], box[3 + a] = spaces[s, 3 + a] - size[b, a], spaces[s, 3 + a]
        else:
            box[a], box[3 + a] = spaces[s, a], spaces[s, a] + size[b, a]


@helper
def neighbours(spaces: Int64s, s: int, placed: Int64s, count: int, margin: Int64s, near: Int64s) -> int:
    """Write the placed boxes within `margin` of the space into `near`; return their number."""
    found = 0
    for j in range(count):
        apart = False
        for a in range(3):
            apart = apart or placed[j, a] > spaces[s, 3 + a] + margin[a]
            apart = apart or placed[j, 3 + a] < spaces[s, a] - margin[a]
        if not apart:
            near[found] = j
            found += 1
    return found


@helper
def touching_fraction(
    box: Int64s, container: Int64s, placed: Int64s, near: Int64s, found: int, margin: Int64s
) -> float:
    """Return the fraction of the box's surface within `margin` of the container's walls or of placed boxes.

    Parameters
    ----------
    box, container
        ``(6,)`` corners.
    placed
        ``(p, 7)`` corners of the placed boxes.
    near, found
        The first `found` numbers of `near` are the placed boxes that may touch.
    margin
        ``(3,)`` distance that counts as touching.
    """
    surface, touched = 0.0, 0.0
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        face = float(box[3 + b] - box[b]) * float(box[3 + c] - box[c])
        surface += 2.0 * face
        for high in range(2):
            gap = container[3 + a] - box[3 + a] if high else box[a] - container[a]
            area = face if gap <= margin[a] else 0.0
            k = 0
            while area < face and k < found:
                j = near[k]
                gap = placed[j, a] - box[3 + a] if high else box[a] - placed[j, 3 + a]
                if 0 <= gap <= margin[a]:
                    wide = min(box[3 + b], placed[j, 3 + b]) - max(box[b], placed[j, b])
                    deep = min(box[3 + c], placed[j, 3 + c]) - max(box[c], placed[j, c])
                    area += float(max(wide, 0)) * float(max(deep, 0))
                k += 1
            touched += min(area, face)
    return touched / surface


@helper
def usable_lengths(usable: Int64s, words: np.ndarray, sides: Int64s, starts: Int64s, demand: Int64s) -> None:
    """Write for each axis and length the longest row of boxes that is no longer than it.

    This is the bounded subset-sum problem, solved for all lengths at once by shifting a bit set: bit l is set
    if some boxes in a row have the total length l. The boxes of a type enter in groups of 1, 2, 4, ..., so a
    demand of d needs about log2(d) shifts.

    Parameters
    ----------
    usable
        ``(3, l)`` written.
    words
        uint64 work array of at least l bits.
    sides, starts
        ``(r, 2)`` item type and side length; the rows of axis a begin at ``starts[a]``.
    demand
        ``(k,)`` number of boxes left of each item type.
    """
    for axis in range(3):
        for w in range(words.size):
            words[w] = np.uint64(0)
        words[0] = np.uint64(1)
        for r in range(starts[axis], starts[axis + 1]):
            left, step = demand[sides[r, 0]], 1
            while left > 0:
                _or_shifted(words, min(step, left) * sides[r, 1])
                left -= step
                step *= 2
        top = 0
        for length in range(usable.shape[1]):
            if (words[length >> 6] >> np.uint64(length & 63)) & np.uint64(1):
                top = length
            usable[axis, length] = top


@helper
def _or_shifted(words: np.ndarray, shift: int) -> None:
    """Add to a bit set all its members plus `shift` (in place)."""
    skip, bits = shift >> 6, np.uint64(shift & 63)
    for w in range(words.size - 1, skip - 1, -1):
        more = words[w - skip] << bits
        if bits and w > skip:
            more |= words[w - skip - 1] >> (np.uint64(64) - bits)
        words[w] |= more
