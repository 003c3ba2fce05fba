"""Remove corners of polygons so that the result contains them and is nowhere far from them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s

# Strategy. Two changes only add area: a reflex corner is left out, which adds a triangle; and an edge between two
# convex corners is replaced by the point where the edges beside it meet. Each has a cost, the height of the triangle
# that it adds. In each pass all changes are made that cost less than those near them and keep the sum of the heights
# at a place within the tolerance; changes near one another exclude each other.


class Corners(NamedTuple):
    """Corners of closed polygons, the inside to their left.

    Attributes
    ----------
    point
        ``(n, 2)`` mm.
    before, after
        ``(n,)`` the corners beside each one.
    added
        ``(n,)`` mm, by which the edge after each corner may be outside the original polygon.
    """

    point: Floats
    before: Int64s
    after: Int64s
    added: Floats


class _Changes(NamedTuple):
    """For each corner the cost of a change there, and the point that replaces it and the next one, if it is convex."""

    cost: Floats
    convex: Bools
    meeting: Floats


def simplify_outward(loops: Sequence[Floats], tolerance: float) -> list[Floats]:
    """Return polygons ``(k, 2)`` that contain given ones, whose insides are to the left, within a tolerance (mm).

    Polygons with a hole may touch or intersect themselves afterwards where they are thinner than the tolerance.
    """
    corners = _joined([loop for loop in loops if len(loop) > 2])
    while len(corners.point):
        changes = _changes(corners)
        chosen = _chosen(corners, np.where(changes.cost <= tolerance, changes.cost, np.inf))
        if not chosen.any():
            break
        corners = _changed(corners, changes, chosen)
    return _loops(corners)


def _joined(loops: Sequence[Floats]) -> Corners:
    if not loops:
        none = np.zeros(0, np.int64)
        return Corners(np.zeros((0, 2)), none, none, np.zeros(0))
    first = np.cumsum([0, *(len(loop) for loop in loops)])
    order = [np.arange(a, b) for a, b in zip(first[:-1], first[1:], strict=True)]
    before = np.concatenate([np.roll(o, 1) for o in order])
    after = np.concatenate([np.roll(o, -1) for o in order])
    return Corners(np.concatenate(loops), before, after, np.zeros(int(first[-1])))


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _changes(corners: Corners) -> _Changes:
    """Return the cost of the change at each corner, infinite where there is none."""
    p, before, after, added = corners
    a, b, c = p[before], p[after], p[after[after]]
    turn = _cross(p - a, b - p)
    chord = b - a
    length = np.maximum(np.hypot(chord[:, 0], chord[:, 1]), 1e-12)
    reflex = np.where(turn <= 0.0, np.abs(turn) / length + np.maximum(added[before], added), np.inf)
    edge, one, two = b - p, p - a, c - b
    turning = _cross(one, two)
    convex = (turn > 0.0) & (turn[after] > 0.0) & (turning > 1e-9)
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = np.where(convex, _cross(edge, two) / np.where(convex, turning, 1.0), 0.0)
    meeting = p + one * beyond[:, None]
    span = np.maximum(np.hypot(edge[:, 0], edge[:, 1]), 1e-12)
    height = np.abs(_cross(edge, meeting - p)) / span
    cost = np.where(convex, height + added, np.inf)
    cost = np.where(convex, np.maximum(cost, np.maximum(added[before], added[after])), cost)
    short = after[after[after]] == np.arange(len(p))  # a triangle stays
    cost = np.where(turn > 0.0, cost, reflex)
    return _Changes(np.where(short, np.inf, cost), turn > 0.0, meeting)


def _chosen(corners: Corners, cost: Floats) -> Bools:
    """Return the changes that are the cheapest among those up to three corners away."""
    n = len(cost)
    rank = np.empty(n, np.int64)
    rank[np.lexsort((np.arange(n), cost))] = np.arange(n)
    least, back, ahead = rank.copy(), corners.before, corners.after
    for _ in range(3):
        least = np.minimum(least, np.minimum(rank[back], rank[ahead]))
        back, ahead = corners.before[back], corners.after[ahead]
    return np.asarray(np.isfinite(cost) & (least == rank))


def _changed(corners: Corners, changes: _Changes, chosen: Bools) -> Corners:
    """Return the corners after the chosen changes."""
    point, added = corners.point.copy(), corners.added.copy()
    before, after = corners.before.copy(), corners.after.copy()
    reflex, convex = np.flatnonzero(chosen & ~changes.convex), np.flatnonzero(chosen & changes.convex)
    added[before[reflex]] = changes.cost[reflex]
    removed = np.concatenate((reflex, after[convex]))
    point[convex] = changes.meeting[convex]
    added[before[convex]] = changes.cost[convex]
    added[convex] = changes.cost[convex]
    after[before[removed]], before[after[removed]] = after[removed], before[removed]
    kept = np.ones(len(point), bool)
    kept[removed] = False
    number = np.cumsum(kept) - 1
    return Corners(point[kept], number[before[kept]], number[after[kept]], added[kept])


def _loops(corners: Corners) -> list[Floats]:
    loops, after, seen = [], corners.after.tolist(), np.zeros(len(corners.point), bool)
    for first in range(len(after)):
        walk, at = [], first
        while not seen[at]:
            seen[at] = True
            walk.append(at)
            at = after[at]
        if walk:
            loops.append(corners.point[walk])
    return loops
