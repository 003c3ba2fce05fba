"""Collision, distance and directional distance of two sets of convex pieces."""

import numpy as np
from numba import njit

from amprep.arrays import Bools, Floats
from amprep.kernels.bounding.gjk import TOLERANCE, PieceArrays, pair_distance, pair_travel
from amprep.kernels.helper import helper

# Strategy. All is computed in the coordinates of set a, where only the boxes of the pieces of b must be turned. Two
# boxes are apart if their shadows on one of their six axes are (the axes of edge pairs are left to GJK). Pieces whose
# box misses the box of the other set are dropped first, so a pose without contact costs little more than the
# transformed boxes.

SIMPLEX_ROWS = 4
"""Rows of the work array below those of the pieces; GJK keeps its simplex there."""

COLUMNS = 7
"""Columns of the work array: centre and half size of a box of b in the coordinates of a, number of its piece."""

SMALLEST = 1e-300
"""Pieces with no margin collide unless a plane proves a distance of at least this."""


@helper
def _turn_box(b, j, pose, work, row):
    """Write the box of piece j of b to a row: its centre and its extent along the axes of a."""
    for k in range(3):
        work[row, k] = pose[k, 3]
        work[row, 3 + k] = 0.0
        for c in range(3):
            work[row, k] += pose[k, c] * b.centre[j, c]
            work[row, 3 + k] += abs(pose[k, c]) * b.half[j, c]
    work[row, 6] = j


@helper
def _boxes_apart(a, i, b, j, pose, work, row, margin):
    """Return whether an axis of one of two boxes shows a gap of at least the margin."""
    for k in range(3):
        if abs(work[row, k] - a.centre[i, k]) > a.half[i, k] + work[row, 3 + k] + margin:
            return True
    for c in range(3):
        between, extent = 0.0, b.half[j, c] + margin
        for k in range(3):
            between += pose[k, c] * (work[row, k] - a.centre[i, k])
            extent += abs(pose[k, c]) * a.half[i, k]
        if abs(between) > extent:
            return True
    return False


@helper
def _near_boxes(a, b, pose, margin, work):
    """Write the boxes of b that are near the box of the set a; return their number."""
    everything, others = a.first.shape[0] - 1, b.first.shape[0] - 1
    _turn_box(b, others, pose, work, 0)
    if _boxes_apart(a, everything, b, others, pose, work, 0, margin):
        return 0
    count = 0
    for j in range(others):
        _turn_box(b, j, pose, work, 1 + count)
        if not _boxes_apart(a, everything, b, j, pose, work, 1 + count, margin):
            count += 1
    return count


@njit(cache=True)
def collide(a: PieceArrays, b: PieceArrays, pose: Floats, margin: float, work: Floats) -> bool:
    """Return whether a piece of a is closer to a piece of b than the margin; touching pieces collide at margin 0.

    Parameters
    ----------
    a, b
        The sets, each in its own coordinates.
    pose
        ``(4, 4)`` rigid motion from the coordinates of b to those of a.
    margin
        At least 0, mm.
    work
        ``(pieces of b + 1 + SIMPLEX_ROWS, COLUMNS)``, modified in place.
    """
    simplex = work[work.shape[0] - SIMPLEX_ROWS :]
    limit = max(margin - TOLERANCE, SMALLEST)
    near = _near_boxes(a, b, pose, margin, work)
    if near == 0:
        return False
    for i in range(a.first.shape[0] - 1):
        if _boxes_apart(a, i, b, b.first.shape[0] - 1, pose, work, 0, margin):
            continue
        for row in range(1, near + 1):
            j = int(work[row, 6])
            if _boxes_apart(a, i, b, j, pose, work, row, margin):
                continue
            if pair_distance(a, i, b, j, pose, limit, limit, simplex)[0] < limit:
                return True
    return False


@njit(cache=True)
def distance(a: PieceArrays, b: PieceArrays, pose: Floats, most: float, work: Floats) -> float:
    """Return the least distance of the pieces of two sets, at most `most`, mm; 0 if they intersect.

    See `collide` for the other arguments.
    """
    simplex = work[work.shape[0] - SIMPLEX_ROWS :]
    near = _near_boxes(a, b, pose, most, work)
    least = most
    for i in range(a.first.shape[0] - 1):
        for row in range(1, near + 1):
            j = int(work[row, 6])
            if not _boxes_apart(a, i, b, j, pose, work, row, least):
                least = min(least, pair_distance(a, i, b, j, pose, 0.0, least, simplex)[0])
                if least == 0.0:
                    return 0.0
    return least


@helper
def _box_travel(a, i, b, j, pose, work, row, ray, margin):
    """Return the least travel of box i of a at which it may be within the margin of box j of b; inf for none."""
    enter, leave = 0.0, np.inf
    for k in range(6):
        if k < 3:
            speed, between = ray[k], work[row, k] - a.centre[i, k]
            extent = a.half[i, k] + work[row, 3 + k] + margin
        else:
            c = k - 3
            speed, between, extent = 0.0, 0.0, b.half[j, c] + margin
            for m in range(3):
                speed += pose[m, c] * ray[m]
                between += pose[m, c] * (work[row, m] - a.centre[i, m])
                extent += abs(pose[m, c]) * a.half[i, m]
        if abs(speed) <= 1e-14:
            if abs(between) > extent:
                return np.inf
        else:
            middle, reach = between / speed, extent / abs(speed)
            enter, leave = max(enter, middle - reach), min(leave, middle + reach)
    return enter if enter <= leave else np.inf


@njit(cache=True)
def directional_distance(
    a: PieceArrays, b: PieceArrays, pose: Floats, ray: Floats, margin: float, upto: float, work: Floats
) -> float:
    """Return how far set a may move along a ray until its distance to set b is the margin (thesis 2.6).

    The value is never longer than the exact one; it is at most `upto`, and 0 if the sets are closer than the margin.

    Parameters
    ----------
    a, b, pose, work
        See `collide`.
    ray
        ``(3,)`` unit vector in the coordinates of a.
    margin, upto
        The least distance that must remain, and the longest travel of interest, mm; both at least 0.
    """
    simplex = work[work.shape[0] - SIMPLEX_ROWS :]
    pieces, others = a.first.shape[0] - 1, b.first.shape[0] - 1
    _turn_box(b, others, pose, work, 0)
    if _box_travel(a, pieces, b, others, pose, work, 0, ray, margin) >= upto:
        return upto
    near, first_i, first_row, soonest = 0, 0, 0, upto
    for j in range(others):
        _turn_box(b, j, pose, work, 1 + near)
        if _box_travel(a, pieces, b, j, pose, work, 1 + near, ray, margin) < upto:
            near += 1
    for i in range(pieces):
        for row in range(1, near + 1):
            enter = _box_travel(a, i, b, int(work[row, 6]), pose, work, row, ray, margin)
            if enter < soonest:
                first_i, first_row, soonest = i, row, enter
    if soonest >= upto:
        return upto
    best = pair_travel(a, first_i, b, int(work[first_row, 6]), pose, ray, margin, upto, simplex)
    for i in range(pieces):
        if _box_travel(a, i, b, others, pose, work, 0, ray, margin) >= best:
            continue
        for row in range(1, near + 1):
            j = int(work[row, 6])
            if (i != first_i or row != first_row) and _box_travel(
                a, i, b, j, pose, work, row, ray, margin
            ) < best:
                best = min(best, pair_travel(a, i, b, j, pose, ray, margin, best, simplex))
    return float(best)


@njit(cache=True)
def collide_at(
    a: PieceArrays, b: PieceArrays, poses: Floats, margin: float, work: Floats, hit: Bools
) -> None:
    """Write to `hit` ``(n,)`` whether the sets collide at each of the poses ``(n, 4, 4)``; see `collide`."""
    for n in range(poses.shape[0]):
        hit[n] = collide(a, b, poses[n], margin, work)


@njit(cache=True)
def distance_at(
    a: PieceArrays, b: PieceArrays, poses: Floats, most: float, work: Floats, found: Floats
) -> None:
    """Write to `found` ``(n,)`` the distance of the sets at each of the poses ``(n, 4, 4)``; see `distance`."""
    for n in range(poses.shape[0]):
        found[n] = distance(a, b, poses[n], most, work)


@njit(cache=True)
def directional_distance_at(
    a: PieceArrays,
    b: PieceArrays,
    poses: Floats,
    rays: Floats,
    margin: float,
    upto: float,
    work: Floats,
    found: Floats,
) -> None:
    """Write to `found` ``(n,)`` the directional distance along each of the rays ``(n, 3)``."""
    for n in range(poses.shape[0]):
        found[n] = directional_distance(a, b, poses[n], rays[n], margin, upto, work)


@njit(cache=True)
def vectors_from(
    a: PieceArrays, i: int, points: PieceArrays, pose: Floats, work: Floats, found: Floats
) -> None:
    """Write to `found` ``(n, 3)`` the vectors from piece i of a to the nearest points of sets; zero where they meet.

    The sets of `points` are pieces of one vertex each.
    """
    simplex = work[work.shape[0] - SIMPLEX_ROWS :]
    for n in range(points.first.shape[0] - 1):
        _, x, y, z = pair_distance(a, i, points, n, pose, 0.0, np.inf, simplex)
        found[n, 0], found[n, 1], found[n, 2] = -x, -y, -z
