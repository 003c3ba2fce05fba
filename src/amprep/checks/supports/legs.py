"""Judge legs: no stretch of support without a brace or a wall beside it is too long for its width."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.supports.slices import Slices, slices_of
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.containment import inside
from amprep.model.build import Build, PlacedPart, SupportBody
from amprep.model.control import Stop

PROMISE = "legs"

STEP = 0.5
"""Distance (mm) of the planes that cut supports; a leg may be longer by it than is measured."""

_MOST_PLANES = 400
"""Largest number of planes for one support."""

_GRANT = 1.02
"""Factor that is granted on the ratio."""

_WIDER, _LAYERS = 1.05, 2
"""Girth of a contour, in usual ones, from which a brace is beside it, and the layers of the grid that a brace takes
until it is clear of the leg."""

_HIGH = 2.0
"""Height, in its widths, from which a wider place inside a leg divides it; a bend or the end of a brace is lower."""

_TOUCH = 0.1
"""Horizontal distance (mm) up to which a support touches a wall of a part."""


class Leg(NamedTuple):
    """A stretch of support without a brace or a wall beside it.

    Attributes
    ----------
    length_mm, width_mm
        Length between the lowest and the highest plane that cuts it, and its greatest width.
    position_mm
        ``(3,)`` middle of the lowest contour.
    """

    length_mm: float
    width_mm: float
    position_mm: Floats

    @property
    def ratio(self) -> float:
        """Length over width."""
        return self.length_mm / max(self.width_mm, 1e-3)


def check_legs(build: Build, stop: Stop, solids: KnownSolids | None = None) -> list[Violation]:
    """Return the supports of a build with a leg above `leg_ratio`; walls without thickness are not judged.

    `solids` are shared with other judges.
    """
    limit = build.settings.rules.leg_ratio
    solids = solids or KnownSolids()
    found: list[Violation] = []
    for body in build.supports:
        if stop() or limit <= 0.0:
            return found
        legs = [] if body.surface else legs_above(body, build, limit, solids)
        if legs:
            worst = max(legs, key=lambda leg: leg.ratio)
            message = (
                f"a leg of {worst.length_mm:.1f} mm is {worst.width_mm:.2f} mm wide, {worst.ratio:.1f} to 1, expected "
                f"at most {limit:g} to 1; at {place_words(worst.position_mm)} mm ({len(legs)} such legs)"
            )
            found.append(Violation(PROMISE, body.name, message))
    return found


def legs_above(body: SupportBody, build: Build, limit: float, solids: KnownSolids | None = None) -> list[Leg]:
    """Return the legs of a support with a ratio of length to width above a limit.

    Strategy. Horizontal planes cut the solid into contours. A leg is a chain of contours of which each has exactly one
    above and one below; at a brace, a fork or an end it ends. Contours there that still hold the brace are not free.
    Of the stretches of a chain, each as wide as its widest contour, the one counts that is longest for its width.
    What is no higher than one cell, such as the posts beside its windows, is a detail of the cell. Long chains are cut
    where they touch a part, and end where their tips begin.
    """
    low, high = (float(corner[2]) for corner in body.mesh.bounds)
    step = max(STEP, (high - low) / _MOST_PLANES)
    rules = build.settings.rules
    cell = build.settings.sizes_of(body).square_mm * float(np.tan(np.radians(rules.strut_angle_deg)))
    sliced = (solids or KnownSolids()).sliced(body.mesh)
    slices = slices_of(sliced, np.arange(low + step / 2.0, high, step))
    legs = []
    for chain in _long_enough(slices, _chains(slices), limit, cell):
        if _worst(slices, chain).ratio > limit * _GRANT:
            tip = build.settings.sizes_of(body).tip_height_mm
            free = ~_touches(slices, chain, build, tip) & ~_beside_braces(slices, chain, _LAYERS * cell)
            legs += [_worst(slices, own) for own in _runs(chain, free)]
    # planes do not meet the ends of a leg: its length is known to one distance of planes
    too_long = [leg for leg in legs if leg.length_mm - step > limit * leg.width_mm]
    return [leg for leg in too_long if leg.length_mm > cell and leg.ratio > limit * _GRANT]


def _chains(slices: Slices) -> list[Int64s]:
    """Return the chains of outer contours, from below, longest possible."""
    outer = slices.is_outer
    follows = np.zeros(len(outer), np.bool_)
    follows[slices.above[slices.above >= 0]] = True
    chains = []
    for first in np.flatnonzero(outer & ~follows).tolist():
        chain, at = [first], int(slices.above[first])
        while at >= 0:
            chain.append(at)
            at = int(slices.above[at])
        chains.append(np.array(chain))
    return chains


def _long_enough(slices: Slices, chains: list[Int64s], limit: float, cell: float) -> list[Int64s]:
    """Return the chains that may be legs: longer than a cell, and long for their least width."""
    ends = np.array([(chain[0], chain[-1]) for chain in chains], np.int64).reshape(-1, 2)
    length = np.diff(slices.heights_of(ends), axis=1)[:, 0]
    high = np.flatnonzero(length > cell)
    if not len(high):
        return []
    own = [chains[row] for row in high]
    starts = np.cumsum([0, *(len(chain) for chain in own[:-1])])
    width = np.minimum.reduceat(slices.widths_of(np.concatenate(own)), starts)
    return [own[row] for row in np.flatnonzero(length[high] > limit * _GRANT * width)]


def _beside_braces(slices: Slices, chain: Int64s, longest: float) -> Bools:
    """Tell which contours at the ends of a chain hold a brace, too, at most so many mm; none does on the plate."""
    heights = slices.heights_of(chain)
    girth = _girths(slices, chain)
    wide = girth > _WIDER * np.median(girth)
    below = np.logical_and.accumulate(wide & (heights < heights[0] + longest))
    above = np.logical_and.accumulate((wide & (heights > heights[-1] - longest))[::-1])[::-1]
    return np.asarray((below & (slices.contours.plane[chain[0]] > 0)) | above)


def _girths(slices: Slices, chain: Int64s) -> Floats:
    """Return the mean width of the hull of each contour of a chain, mm."""
    angles = np.arange(8) * np.pi / 8.0
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.array(
        [np.ptp(slices.contours.points_of(int(each)) @ directions.T, axis=0).mean() for each in chain]
    )


def _worst(slices: Slices, chain: Int64s) -> Leg:
    """Return the stretch of a chain that is longest for its width."""
    heights, widths = slices.heights_of(chain), slices.widths_of(chain)
    first, last, best = 0, 0, 0.0
    for width in np.unique(np.round(widths, 2)) + 0.005:
        for own in _stretches(heights, widths, width):
            ratio = (heights[own[-1]] - heights[own[0]]) / width
            if ratio > best:
                first, last, best = int(own[0]), int(own[-1]), float(ratio)
    length, lowest = float(heights[last] - heights[first]), slices.points_of(int(chain[first]))
    return Leg(length, length / best if best else float(widths[0]), lowest.mean(axis=0))


def _stretches(heights: Floats, widths: Floats, width: float) -> list[Int64s]:
    """Return the stretches at most so wide, over wider places that are low for their width."""
    narrow = widths <= width
    index = np.arange(len(narrow))
    for wider in _runs(index, ~narrow):
        low, high = int(wider[0]) - 1, int(wider[-1]) + 1
        if low >= 0 and high < len(index) and heights[high] - heights[low] < _HIGH * widths[wider].max():
            narrow[wider] = True
    return _runs(index, narrow)


def _runs(chain: Int64s, free: Bools) -> list[Int64s]:
    """Return the runs of consecutive contours that are free."""
    if not free.any():
        return []
    changes = np.flatnonzero(np.diff(free)) + 1
    return [run for run, own in zip(np.split(chain, changes), np.split(free, changes), strict=True) if own[0]]


def _touches(slices: Slices, chain: Int64s, build: Build, tip: float) -> Bools:
    """Tell which contours of a chain touch a part, some with tips of a height (mm)."""
    points = [slices.points_of(int(contour)) for contour in chain]
    owner = np.repeat(np.arange(len(chain)), [len(each) for each in points])
    every = np.concatenate(points)
    touches = np.zeros(len(chain), np.bool_)
    for placed in build.parts:
        touches[owner[_near_part(every, placed)]] = True
        for share in (0.5, 1.0) if tip > 0.0 else ():
            above = every + (0.0, 0.0, share * tip)
            touches[owner[inside(above, placed.mesh.vertices, placed.mesh.triangles)]] = True
    return touches


def _near_part(points: Floats, placed: PlacedPart) -> Bools:
    """Tell which points are within `_TOUCH` of a part, horizontally."""
    lo, hi = placed.mesh.bounds
    near = ((points >= np.asarray(lo) - _TOUCH) & (points <= np.asarray(hi) + _TOUCH)).all(axis=1)
    found = np.zeros(len(points), np.bool_)
    rows = np.flatnonzero(near)
    for angle in np.arange(8) * np.pi / 4.0:
        moved = points[rows] + _TOUCH * np.array([np.cos(angle), np.sin(angle), 0.0])
        found[rows] |= inside(moved, placed.mesh.vertices, placed.mesh.triangles)
    return found
