"""Maximal empty spaces, compiled: cut by what is placed, chosen by corner, judged by what they touch.

Lengths are whole numbers here, so that nothing depends on rounding. A space is a row ``x0, y0, z0, x1, y1, z1,
distance, corner``: the corner (bits 1, 2, 4: at the far side in x, y, z) that is nearest to the same corner of
the room, and its Manhattan distance.
"""

import numpy as np

from amprep.kernels.boxes.places import helper

FAR, CORNER = 6, 7
"""Places in a space after its corners."""


@helper
def anchor(space, room, flat):
    """Write the nearest corner and its distance into the space; when flat, only corners on the plate."""
    distance, corner = 0, 0
    for a in range(3):
        near, far = space[a] - room[a], room[3 + a] - space[3 + a]
        if far < near and not (flat and a == 2):
            near = far
            corner |= 1 << a
        distance += near
    space[FAR], space[CORNER] = distance, corner


@helper
def _within(one, i, other, j):
    """Whether a space lies within another."""
    inside = True
    for a in range(3):
        inside = inside and one[i, a] >= other[j, a] and one[i, 3 + a] <= other[j, 3 + a]
    return inside


@helper
def _holds(spaces, s, small, number):
    """Whether one of the small boxes fits the space."""
    x, y, z = spaces[s, 3] - spaces[s, 0], spaces[s, 4] - spaces[s, 1], spaces[s, 5] - spaces[s, 2]
    k = 0
    while k < number and (small[k, 0] > x or small[k, 1] > y or small[k, 2] > z):
        k += 1
    return k < number


@helper
def sift(spaces, count, small, number):
    """Drop the spaces in which none of the small boxes fits (in place); return how many are left."""
    kept = 0
    for s in range(count):
        if _holds(spaces, s, small, number):
            if kept < s:
                for c in range(8):
                    spaces[kept, c] = spaces[s, c]
            kept += 1
    return kept


@helper
def cut(spaces, count, box, room, small, number, flat, fresh, touching):
    """Cut what the box takes out of the spaces (in place); return how many there are then.

    Each space that the box meets gives way to the up to six that remain beside the box; those in which none
    of the small boxes fits, or that lie within another one, are dropped (Lai and Chan 1997). When flat,
    nothing may lie above the box or below it. `fresh` ``(f, 8)`` and `touching` ``(s,)`` are scratch.
    """
    kept, gone, near = 0, 0, 0
    for s in range(count):
        apart, touches = False, False
        for a in range(3):
            if not (flat and a == 2):
                apart = apart or box[a] >= spaces[s, 3 + a] or box[3 + a] <= spaces[s, a]
                touches = touches or box[a] == spaces[s, 3 + a] or box[3 + a] == spaces[s, a]
        if not apart:
            for c in range(6):
                fresh[gone, c] = spaces[s, c]
            gone += 1
            continue
        if kept < s:
            for c in range(8):
                spaces[kept, c] = spaces[s, c]
        if touches:
            touching[near] = kept
            near += 1
        kept += 1
    for side in range(6):
        a = side % 3
        if flat and a == 2:
            continue
        # only a space that touches the same side of the box can hold a fresh one
        first, new = gone, gone
        for s in range(gone):
            left = box[a] - fresh[s, a] if side < 3 else fresh[s, 3 + a] - box[3 + a]
            if left <= 0:
                continue
            for c in range(6):
                fresh[new, c] = fresh[s, c]
            if side < 3:
                fresh[new, 3 + a] = box[a]
            else:
                fresh[new, a] = box[3 + a]
            inside, j = not _holds(fresh, new, small, number), 0
            while not inside and j < near:
                inside = _within(fresh, new, spaces, touching[j])
                j += 1
            j = first
            while not inside and j < new:
                inside = _within(fresh, new, fresh, j)
                if not inside and _within(fresh, j, fresh, new):
                    new -= 1
                    for c in range(6):
                        fresh[j, c] = fresh[new, c]
                        fresh[new, c] = fresh[new + 1, c]
                else:
                    j += 1
            if not inside:
                new += 1
        for s in range(first, new):
            if kept < spaces.shape[0]:
                for c in range(6):
                    spaces[kept, c] = fresh[s, c]
                anchor(spaces[kept], room, flat)
                kept += 1
    return kept


@helper
def nearest(spaces, count):
    """Return the space nearest to a corner of the room, of equals the largest."""
    best, best_volume = 0, -1.0
    for s in range(count):
        if spaces[s, FAR] > spaces[best, FAR]:
            continue
        volume = 1.0
        for a in range(3):
            volume *= spaces[s, 3 + a] - spaces[s, a]
        if spaces[s, FAR] < spaces[best, FAR] or volume > best_volume:
            best, best_volume = s, volume
    return best


@helper
def put(spaces, s, size, b, box):
    """Write the box of block b at the corner of space s."""
    corner = spaces[s, CORNER]
    for a in range(3):
        if corner & (1 << a):
            box[a], box[3 + a] = spaces[s, 3 + a] - size[b, a], spaces[s, 3 + a]
        else:
            box[a], box[3 + a] = spaces[s, a], spaces[s, a] + size[b, a]


@helper
def neighbours(spaces, s, placed, count, margin, near):
    """Write the placed boxes within `margin` of the space, return their number."""
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
def contact(box, room, placed, near, found, margin):
    """Return the share of the box's surface that is within `margin` of walls and placed boxes."""
    whole, touched = 0.0, 0.0
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        face = float(box[3 + b] - box[b]) * float(box[3 + c] - box[c])
        whole += 2.0 * face
        for high in range(2):
            gap = room[3 + a] - box[3 + a] if high else box[a] - room[a]
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
    return touched / whole


@helper
def measure_reach(reach, words, sides, starts, stock):
    """Write ``(3, l)`` the greatest sum of sides along each axis that is no longer than each length.

    `sides` ``(r, 2)`` are kind and length of the sides that may lie along an axis, those of axis a from
    ``starts[a]`` on; there are as many of each as boxes in stock. `words` is scratch for the bits.
    """
    for axis in range(3):
        for w in range(words.size):
            words[w] = np.uint64(0)
        words[0] = np.uint64(1)
        for r in range(starts[axis], starts[axis + 1]):
            left, step = stock[sides[r, 0]], 1
            while left > 0:
                shift = min(step, left) * sides[r, 1]
                left -= step
                step *= 2
                skip, bits = shift >> 6, np.uint64(shift & 63)
                for w in range(words.size - 1, skip - 1, -1):
                    more = words[w - skip] << bits
                    if bits and w > skip:
                        more |= words[w - skip - 1] >> (np.uint64(64) - bits)
                    words[w] |= more
        top = 0
        for length in range(reach.shape[1]):
            if (words[length >> 6] >> np.uint64(length & 63)) & np.uint64(1):
                top = length
            reach[axis, length] = top
