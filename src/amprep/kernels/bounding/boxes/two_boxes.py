"""Search two axis-parallel boxes that cover a set, over planes whose far sides are enclosed in advance.

Faces are numbered 0 to 5: lower x, y, z, upper x, y, z, as in a row ``x0 y0 z0 x1 y1 z1`` of a box.
"""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import helper


@helper
def _volume(box: Floats) -> float:
    """Volume of a box; 0 if it is empty."""
    x, y, z = box[3] - box[0], box[4] - box[1], box[5] - box[2]
    return float(x * y * z) if x > 0.0 and y > 0.0 and z > 0.0 else 0.0


@helper
def _common(a: Floats, b: Floats, out: Floats) -> None:
    for c in range(3):
        out[c] = max(a[c], b[c])
        out[c + 3] = min(a[c + 3], b[c + 3])


@helper
def _outside(box: Floats, covered: Floats, work: Floats) -> float:
    """Volume of a box outside at most two boxes, by inclusion and exclusion."""
    volume = float(_volume(box))
    if len(covered) == 0 or volume == 0.0:
        return volume
    for b in range(len(covered)):
        _common(box, covered[b], work[b])
        volume -= _volume(work[b])
    if len(covered) == 2:
        _common(work[0], work[1], work[0])
        volume += _volume(work[0])
    return volume


@helper
def _join(a: Floats, b: Floats, out: Floats) -> None:
    for c in range(3):
        out[c] = min(a[c], b[c])
        out[c + 3] = max(a[c + 3], b[c + 3])


@helper
def _place(box: Floats, planes: Floats, counts: Int64s, face: int, k: int) -> int:
    """Move a face to its k-th plane, counted from the smallest box; return the number of the plane."""
    axis = face % 3
    plane = k if face >= 3 else counts[axis] - 1 - k
    box[face] = planes[axis, plane]
    return plane


@njit(cache=True)
def search_union(
    planes: Floats,
    counts: Int64s,
    beyond: Floats,
    covered: Floats,
    limit: float,
    slack: float,
    only: int,
    found: Floats,
) -> int:
    """Find the two boxes of least union, for each choice of three faces that the first box leaves free.

    Strategy: each of the six faces of the enclosing box is touched by a box, so one of the two boxes, the
    first, touches three of them. Its three other faces are tried on all planes. The second box encloses what is
    beyond one of the three faces: the join of three boxes that are known. Growing the first box only adds to its
    volume, and the second box cannot be smaller than the join of two of the three; both bounds end loops early.

    Parameters
    ----------
    planes, counts, beyond
        Planes along each axis, from the lowest to the highest coordinate of the set, and the enclosing boxes
        of what is beyond them, as `boxes_beyond` makes them.
    covered
        ``(0 to 2, 6)`` boxes whose volume is free.
    limit
        Results of at least this volume are not wanted.
    slack
        For each choice of faces, results are kept up to this ratio to the best of all; at least 1.
    only
        Number of the only choice of faces that is tried; -1 for all.
    found
        ``(20, 13)``, receives for each choice of faces: the volume (inf: nothing below the limit), both boxes.

    Returns
    -------
    int
        Number of pairs of boxes that were compared.
    """
    one, two, pair, both = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    work = np.empty((2, 6))
    found[:, :] = np.inf
    best = limit
    tried, choice = 0, -1
    for f in range(6):
        for g in range(f + 1, 6):
            for h in range(g + 1, 6):
                choice += 1
                if only >= 0 and choice != only:
                    continue
                own = np.inf
                for c in range(3):
                    one[c] = planes[c, 0]
                    one[c + 3] = planes[c, counts[c] - 1]
                for i in range(counts[f % 3]):
                    at_f = _place(one, planes, counts, f, i)
                    _place(one, planes, counts, g, 0)
                    _place(one, planes, counts, h, 0)
                    if _outside(one, covered, work) >= best * slack:
                        break
                    for j in range(counts[g % 3]):
                        at_g = _place(one, planes, counts, g, j)
                        _place(one, planes, counts, h, 0)
                        if _outside(one, covered, work) >= best * slack:
                            break
                        _join(beyond[f, at_f], beyond[g, at_g], pair)
                        if _outside(pair, covered, work) >= best * slack:
                            continue
                        for k in range(counts[h % 3]):
                            at_h = _place(one, planes, counts, h, k)
                            tried += 1
                            volume = _outside(one, covered, work)
                            if volume >= min(best * slack, own):
                                break
                            _join(pair, beyond[h, at_h], two)
                            volume += _outside(two, covered, work)
                            _common(one, two, both)
                            volume -= _outside(both, covered, work)
                            if volume < own and volume < best * slack:
                                own = volume
                                best = min(best, volume)
                                found[choice, 0] = volume
                                for c in range(6):
                                    found[choice, 1 + c] = one[c]
                                    found[choice, 7 + c] = two[c]
    return tried


@njit(cache=True)
def search_larger(planes: Floats, counts: Int64s, beyond: Floats, found: Floats) -> int:
    """Find the two boxes whose larger one is smallest, for each choice of three free faces.

    Strategy (Bespamyatnikh and Segal): as in `search_union`, but for a fixed place of the first free face the
    other two need not be paired with each other: the further out the second face is, the larger is the first
    box and the smaller the second, so the place of the third face at which they are equally large only moves
    inwards. One sweep finds all of them: O(n^2) for n planes.

    Parameters
    ----------
    planes, counts, beyond, found
        As in `search_union`; the objective is the volume of the larger box.
    """
    one, two, pair = np.empty(6), np.empty(6), np.empty(6)
    found[:, :] = np.inf
    tried, choice = 0, 0
    for f in range(6):
        for g in range(f + 1, 6):
            for h in range(g + 1, 6):
                for c in range(3):
                    one[c] = planes[c, 0]
                    one[c + 3] = planes[c, counts[c] - 1]
                for i in range(counts[f % 3]):
                    at_f = _place(one, planes, counts, f, i)
                    k = counts[h % 3] - 1
                    for j in range(counts[g % 3]):
                        at_g = _place(one, planes, counts, g, j)
                        _join(beyond[f, at_f], beyond[g, at_g], pair)
                        while True:
                            at_h = _place(one, planes, counts, h, k)
                            tried += 1
                            _join(pair, beyond[h, at_h], two)
                            first, second = _volume(one), _volume(two)
                            if max(first, second) < found[choice, 0]:
                                found[choice, 0] = max(first, second)
                                for c in range(6):
                                    found[choice, 1 + c] = one[c]
                                    found[choice, 7 + c] = two[c]
                            if k == 0 or first < second:
                                break
                            k -= 1
                        if first < second and k < counts[h % 3] - 1:
                            k += 1  # the next place of the second face begins where the first box is the larger
                choice += 1
    return tried
