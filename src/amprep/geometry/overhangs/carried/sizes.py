"""Find kind and size of overhang regions at their worst points."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.carried.points import TOLERANCE, TWICE, Carrier, Limits
from amprep.geometry.overhangs.regions import Kind

_PRECISION, _RELATIVE = 0.025, 0.005
"""Precision of ledges, mm, and as a fraction."""

_MOST_PIECES, _MOST_ROUNDS = 2000, 48
"""Largest number of pieces of a region that are searched in one round, and of rounds."""

_INWARDS = 1e-3
"""Distance (mm) from the corners of triangles at which points are measured."""

_UNSEEN = 1e6
"""Ledge (mm) at points from which no straight line leads to an anchor: longer than any other."""

# Strategy. The worst point of a region is that with the longest shortest ledge: no bridge through it is shorter than
# twice that ledge, and at the middle of a bridge it is half the span. The kind is told from the bridge and arch at this
# point, so kind and size do not depend on the limits where the part carries all of the region or nothing.
# The worst point is found by branch and bound: the ledge changes by at most 1 mm a mm, so in a triangle it is at most
# that at its middle plus the triangle's radius. Triangles that may exceed the longest so far are split into two.


class RegionSize(NamedTuple):
    """Kind of a region, its size at its worst point and the limit of that size, mm."""

    kind: Kind
    size: float
    limit: float


class _Points(NamedTuple):
    """Points ``(n, 3)`` mm on faces ``(n,)`` of regions ``(n,)``, and their shortest ledges ``(n,)``."""

    at: Floats
    face: Int64s
    region: Int64s
    ledge: Floats

    def worst(self) -> "_Points":
        """Return the point of each region with the longest ledge."""
        order = np.lexsort((-self.ledge, self.region))
        first = np.ones(len(order), np.bool_)
        first[1:] = self.region[order[1:]] != self.region[order[:-1]]
        rows = order[first]
        return _Points(self.at[rows], self.face[rows], self.region[rows], self.ledge[rows])


def region_sizes(
    carrier: Carrier, corners: Floats, face: Int64s, region: Int64s, holds: Bools
) -> dict[int, RegionSize]:
    """Return kind and size of each region.

    Parameters
    ----------
    carrier
        The faces and the limits.
    corners, face
        ``(k, 3, 3)`` mm: triangles on the faces ``(k,)`` of regions. Those that need support decide.
    region
        ``(k,)`` number of the region of each triangle.
    holds
        For each number whether the part carries the whole region.
    """
    if not len(face):
        return {}
    corners, face, region = _largest(carrier, corners, face, region)
    tests = _corner_tests(corners).reshape(-1, 3)
    worst = _measured(carrier, tests, np.repeat(face, 3), np.repeat(region, 3)).worst()
    for _ in range(_MOST_ROUNDS):
        middle = corners.mean(axis=1)
        found = _measured(carrier, middle, face, region)
        worst = _Points(*(np.concatenate(each) for each in zip(worst, found, strict=True))).worst()
        best = np.zeros(len(holds))
        best[worst.region] = worst.ledge
        radius = np.linalg.norm((corners - middle[:, None])[:, :, :2], axis=2).max(axis=1)
        bound = found.ledge + radius
        step = np.maximum(_PRECISION, _RELATIVE * (best % _UNSEEN))
        open_ = bound > best[region] + step[region]
        rows = np.flatnonzero(open_ & (best[region] < 2 * _UNSEEN))
        if not len(rows):
            break
        rows = _first_of_each(region[rows], bound[rows], rows)
        corners = _halves(corners[rows])
        face, region = np.tile(face[rows], 2), np.tile(region[rows], 2)
    return _named(carrier, worst, holds)


def _measured(carrier: Carrier, points: Floats, face: Int64s, region: Int64s) -> _Points:
    """Measure points; those from which no straight line leads to an anchor have ledges over `_UNSEEN`."""
    spots = carrier.spots(points, face)
    ledge = carrier.ledges(spots)
    unseen = np.flatnonzero(np.isinf(ledge))
    ledge[unseen] = _UNSEEN + np.minimum(spots.least[unseen], _UNSEEN)
    return _Points(points, face, region, ledge)


def _largest(
    carrier: Carrier, corners: Floats, face: Int64s, region: Int64s
) -> tuple[Floats, Int64s, Int64s]:
    """Return the triangles of each region that are the farthest from anchors, at most `_MOST_PIECES`."""
    middle = corners.mean(axis=1)
    radius = np.linalg.norm((corners - middle[:, None])[:, :, :2], axis=2).max(axis=1)
    least = carrier.spots(middle, face).least
    chosen = _first_of_each(region, least + radius, np.arange(len(face)))
    return corners[chosen], face[chosen], region[chosen]


def _first_of_each(region: Int64s, bound: Floats, rows: Int64s) -> Int64s:
    """Return the rows with the greatest bounds of each region, at most `_MOST_PIECES`, in their order."""
    order = np.lexsort((-bound, region))
    first = np.searchsorted(region[order], region[order])
    return np.sort(rows[order[np.arange(len(order)) - first < _MOST_PIECES]])


def _corner_tests(corners: Floats) -> Floats:
    inwards = corners.mean(axis=1)[:, None] - corners
    length = np.linalg.norm(inwards[:, :, :2], axis=2)[:, :, None]
    moved: Floats = corners + inwards * np.minimum(_INWARDS / np.maximum(length, 1e-300), 0.02)
    return moved


def _halves(corners: Floats) -> Floats:
    """Return the triangles ``(2 n, 3, 3)`` on both sides of the middle of the longest side in plan of each triangle."""
    sides = np.linalg.norm((np.roll(corners, -1, axis=1) - corners)[:, :, :2], axis=2)
    turn = (sides.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = (corners[np.arange(len(corners)), turn[:, i]] for i in range(3))
    middle = (a + b) / 2
    return np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


def _named(carrier: Carrier, worst: _Points, holds: Bools) -> dict[int, RegionSize]:
    """Return kind and size of each region from its worst point."""
    bridge, arch = carrier.spans(carrier.spots(worst.at, worst.face), worst.ledge)
    diameter = carrier.diameters[carrier.regions.label[worst.face]]
    by_width = arch / np.sin(np.radians(carrier.limits.angle_deg))
    bore = np.where(np.isnan(diameter) | np.isinf(arch), by_width, diameter)
    looks_round = np.isfinite(arch) & (~np.isnan(diameter) | (arch <= TWICE * worst.ledge))
    spanned = bridge <= TWICE * worst.ledge
    sizes = {}
    for row, number in enumerate(worst.region.tolist()):
        kind: Kind = "bore" if looks_round[row] else "bridge" if spanned[row] else "ledge"
        lengths = float(worst.ledge[row]), float(bridge[row]), float(bore[row])
        sizes[number] = _size(carrier.limits, kind, lengths, bool(holds[number]))
    return sizes


def _size(limits: Limits, kind: Kind, lengths: tuple[float, float, float], holds: bool) -> RegionSize:
    """Return kind and size of a region that looks like `kind`, from the ledge, bridge and bore at its worst point.

    If the part carries the region, but not as what it looks like, it is named after what carries it.
    """
    ledge, bridge, bore = lengths
    if ledge >= 2 * _UNSEEN:
        return RegionSize("ledge", 0.0, limits.ledge) if holds else RegionSize("flat", 0.0, 0.0)
    if ledge >= _UNSEEN:
        return RegionSize("ledge", ledge - _UNSEEN, limits.ledge)
    sizes: dict[Kind, tuple[float, float]] = {
        "bore": (bore, limits.bore),
        "bridge": (bridge, limits.bridge),
        "ledge": (ledge, limits.ledge),
    }
    if holds and sizes[kind][0] > sizes[kind][1] + TOLERANCE:
        kind = min(sizes, key=lambda each: sizes[each][0] / max(sizes[each][1], 1e-9))
    return RegionSize(kind, *sizes[kind])
