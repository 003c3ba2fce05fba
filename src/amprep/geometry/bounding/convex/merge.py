"""Merge cells into fewer convex pieces whose hulls add little volume."""

import heapq
from collections.abc import Callable, Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.cells import hull_corners, hull_volume

# Strategy. The sum of the volumes of the hulls is reduced. First the two neighbouring groups whose common hull adds
# least volume are merged, again and again; a heap holds the pairs. This is greedy, so two kinds of moves follow: a
# cell changes to a neighbouring group, and a cell becomes a group of its own while the two groups that this costs
# least are merged. A hull of 50 points takes 20 microseconds, so that hundreds of cells are merged in a second.

NEAR = 1e-3
"""Cells whose boxes are nearer than this (mm) are neighbours."""

PASSES = 4
"""Largest number of passes over all cells."""


class Groups:
    """Groups of cells, each with the corners, the volume and the box of its hull.

    Attributes
    ----------
    cells
        For each cell the corners ``(k, 3)`` mm of its hull.
    members
        Number of the group -> numbers of its cells.
    volume
        Number of the group -> volume of its hull, mm3.
    """

    def __init__(self, cells: Sequence[Floats]) -> None:
        self.cells = cells
        self.members: dict[int, list[int]] = {}
        self.corners: dict[int, Floats] = {}
        self.volume: dict[int, float] = {}
        self.boxes: dict[int, tuple[Floats, Floats]] = {}
        self.next = 0
        for cell in range(len(cells)):
            self.add([cell], cells[cell])
        self.single = dict(self.volume)

    def add(self, members: list[int], points: Floats) -> int:
        """Add a group, whose hull is that of `points`; return its number."""
        self.next += 1
        self.replace(self.next - 1, members, points)
        return self.next - 1

    def replace(self, group: int, members: list[int], points: Floats) -> None:
        """Set the members of a group, whose hull is that of `points`."""
        self.members[group] = members
        self.corners[group] = hull_corners(points) if len(members) > 1 else points
        self.volume[group] = hull_volume(points)
        self.boxes[group] = (points.min(axis=0), points.max(axis=0))

    def join(self, i: int, j: int) -> int:
        """Replace two groups by one; return its number."""
        members = self.members.pop(i) + self.members.pop(j)
        return self.add(members, np.concatenate((self.corners[i], self.corners[j])))

    def growth(self, i: int, j: int) -> float:
        """Return the volume that the hull of two groups adds to their own hulls; negative where these overlap."""
        together = hull_volume(np.concatenate((self.corners[i], self.corners[j])))
        return together - self.volume[i] - self.volume[j]

    def near(self, i: int, j: int) -> bool:
        """Tell whether the boxes of two groups touch."""
        (lo, hi), (other_lo, other_hi) = self.boxes[i], self.boxes[j]
        return bool((lo <= other_hi + NEAR).all() and (hi >= other_lo - NEAR).all())

    def pairs(self, everywhere: bool) -> list[tuple[float, int, int]]:
        """Return the growth and the numbers of the pairs of neighbours, or of all pairs."""
        numbers = sorted(self.members)
        chosen = ((i, j) for i in numbers for j in numbers if j < i and (everywhere or self.near(i, j)))
        return [(self.growth(i, j), i, j) for i, j in chosen]

    @property
    def total(self) -> float:
        """Sum of the volumes of the hulls, mm3."""
        return sum(self.volume[i] for i in self.members)


def merge_cells(
    cells: Sequence[Floats], most: int, volume: float, stop: Callable[[], bool]
) -> list[list[int]]:
    """Return groups of cells, each to be replaced by the hull of its cells.

    Parameters
    ----------
    cells
        For each cell the corners ``(k, 3)`` mm of its hull.
    most
        Largest number of groups.
    volume
        Total volume of the hulls (mm3) up to which fewer groups are preferred.
    stop
        Ends the search early; then there may be more groups than `most`.
    """
    groups = Groups(cells)
    _merge(groups, most, volume, stop)
    if len(groups.members) <= most and groups.total > volume:
        _improve(groups, most, stop)
    return [sorted(members) for members in groups.members.values()]


def _merge(groups: Groups, most: int, volume: float, stop: Callable[[], bool]) -> None:
    everywhere = False
    heap = groups.pairs(everywhere)
    heapq.heapify(heap)
    total = groups.total
    while len(groups.members) > 1 and not stop():
        if not heap and not everywhere and len(groups.members) > most:
            everywhere = True  # only distant groups are left
            heap = groups.pairs(everywhere)
            heapq.heapify(heap)
        if not heap:
            return
        growth, i, j = heapq.heappop(heap)
        if i not in groups.members or j not in groups.members:
            continue
        if len(groups.members) <= most and growth > 0.0 and total + growth > volume:
            return
        joined = groups.join(i, j)
        total += growth
        for other in list(groups.members):
            if other != joined and (everywhere or groups.near(other, joined)):
                heapq.heappush(heap, (groups.growth(joined, other), joined, other))


def _improve(groups: Groups, most: int, stop: Callable[[], bool]) -> None:
    """Move cells between groups while this reduces the total volume of the hulls."""
    negligible = 1e-9 * groups.total
    for _ in range(PASSES):
        before = groups.total
        for cell in range(len(groups.cells)):
            if stop():
                return
            _relocate(groups, cell, negligible)
        _exchange(groups, most, negligible, stop)
        if groups.total >= before - negligible:
            return


def _without(groups: Groups, cell: int) -> tuple[int, list[int], float]:
    """Return the group of a cell, its other members, and the volume by which their hull is smaller."""
    group = next(number for number, members in groups.members.items() if cell in members)
    rest = [other for other in groups.members[group] if other != cell]
    if not rest:
        return group, rest, 0.0
    left = hull_volume(np.concatenate([groups.cells[other] for other in rest]))
    return group, rest, groups.volume[group] - left


def _relocate(groups: Groups, cell: int, negligible: float) -> None:
    """Move a cell to the neighbouring group that grows least, if its own group shrinks more."""
    group, rest, gain = _without(groups, cell)
    if gain <= negligible:
        return
    points = groups.cells[cell]
    lo, hi = points.min(axis=0) - NEAR, points.max(axis=0) + NEAR
    best, target = gain - negligible, group
    for other, (other_lo, other_hi) in groups.boxes.items():
        if other in groups.members and other != group and (lo <= other_hi).all() and (hi >= other_lo).all():
            cost = hull_volume(np.concatenate((groups.corners[other], points))) - groups.volume[other]
            if cost < best:
                best, target = cost, other
    if target != group:
        groups.replace(group, rest, np.concatenate([groups.cells[other] for other in rest]))
        joined = np.concatenate((groups.corners[target], points))
        groups.replace(target, groups.members[target] + [cell], joined)


def _exchange(groups: Groups, most: int, negligible: float, stop: Callable[[], bool]) -> None:
    """Make a cell a group of its own, and merge the two groups that cost least, while this pays."""
    for _ in range(most):
        if stop():
            return
        gains = [
            (gain - groups.single[cell], cell, group, rest)
            for cell in range(len(groups.cells))
            for group, rest, gain in [_without(groups, cell)]
            if rest
        ]
        if not gains:
            return
        gain, cell, group, rest = max(gains, key=lambda each: each[0])
        cost, pair = 0.0, None
        if len(groups.members) >= most:
            choices = [each for each in groups.pairs(everywhere=False) if group not in each[1:]]
            if not choices:
                return
            cost, *pair = min(choices)
        if gain <= cost + negligible:
            return
        if pair:
            groups.join(*pair)
        groups.replace(group, rest, np.concatenate([groups.cells[other] for other in rest]))
        groups.add([cell], groups.cells[cell])
