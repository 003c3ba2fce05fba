"""Recognise contours of sections that keep the least wall and the least contact for certain.

Strategy. Sections of supports consist of few shapes that repeat, within a section and from plane to plane. A contour
without holes, moved to the origin and rounded to `_GRID`, is a shape. The first contour of each shape is judged alone,
with a margin for the rounding: a disc wider than the least wall fits in it, such discs leave no fin, and its area is
large enough. If the vertices of another contour differ by at most the margin, so do all points of its border, and it
keeps the limits, too: discs that fit elsewhere can only make fins smaller. Contours with holes, and those that fail
this, are left to the exact judge, together with their neighbourhood. The new shapes of a section are set out one
above the other and judged by the same few offsets; polygons side by side take far longer.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s

if TYPE_CHECKING:
    from manifold3d import CrossSection

_GRID = 0.004
"""Length (mm) to which contours are rounded."""

_MARGIN = 0.008
"""Distance (mm) by which borders of equal shapes may differ, with the errors of polygons for circles and contours."""

_STRAIGHT = 0.0005
"""Distance (mm) from a straight line up to which vertices of contours are left out."""

_PHASE = 0.37
"""Where the grid begins, so that round sizes are not between its points."""

_FINE, _COARSE = 32, 8
"""Sides of the polygons that stand for circles, when contours shrink and when they grow."""


class Undecided(NamedTuple):
    """The contours of a section that need an exact judge, and the region with the contours near them."""

    region: "CrossSection"
    around: "CrossSection"


class KnownShapes:
    """The shapes of contours that were judged, and their verdicts.

    Parameters
    ----------
    wall, contact
        Least wall (mm) and least area (mm2) of a section.
    reach
        Distance (mm) from the centres of discs of the least wall beyond which a contour has fins.
    """

    def __init__(self, wall: float, contact: float, reach: float) -> None:
        self.wall, self.contact, self.reach = wall, contact, reach
        self._is_right: dict[bytes, bool] = {}

    def undecided(self, region: "CrossSection") -> Undecided:
        """Return the contours of a section that may break a limit."""
        from manifold3d import CrossSection, FillRule

        if self.wall <= 0.0 or region.is_empty():
            return Undecided(region, region)
        contours = _contours_of(region.simplify(_STRAIGHT))
        simple = np.flatnonzero(_have_no_holes(contours))
        keys = _keys(contours)
        fresh = {keys[row]: row for row in simple.tolist() if keys[row] not in self._is_right}
        if fresh:
            right = self._judged(contours, np.array(list(fresh.values())))
            self._is_right.update(zip(fresh, right.tolist(), strict=True))
        left = np.ones(len(keys), np.bool_)
        left[simple] = [not self._is_right[keys[row]] for row in simple.tolist()]
        near = _near(contours, left, self.reach + self.wall)
        own, around = (
            CrossSection(
                [contours.points_of(row) for row in np.flatnonzero(rows).tolist()], FillRule.Positive
            )
            for rows in (left, near)
        )
        return Undecided(own, around)

    def _judged(self, contours: "_SectionContours", rows: Int64s) -> Bools:
        """Tell which contours keep the limits for certain, by discs that fit in each of them alone."""
        from manifold3d import CrossSection, FillRule, JoinType

        gap = 2.0 * (self.reach + self.wall)
        depth = contours.high[rows, 1] - contours.low[rows, 1] + gap
        start = np.cumsum(depth) - depth
        moved = [
            contours.points_of(row) - contours.low[row] + (0.0, at)
            for row, at in zip(rows.tolist(), start.tolist(), strict=True)
        ]
        column = CrossSection(moved, FillRule.Positive)
        discs = column.offset(-self.wall / 2.0 - _MARGIN, JoinType.Round, 2.0, _FINE)
        fins = column - discs.offset(self.reach - 3.0 * _MARGIN, JoinType.Round, 2.0, _COARSE)
        has_disc, has_fin = (_owners(each, start, gap / 2.0) for each in (discs, fins))
        large = contours.area[rows] >= self.contact + _MARGIN * contours.length[rows]
        return np.asarray(has_disc & ~has_fin & large)


class _SectionContours(NamedTuple):
    """Contours of a section, the inside to their left.

    Attributes
    ----------
    points, first
        ``(n, 2)`` mm, points of all contours, those of contour c from ``first[c]`` up to ``first[c + 1]``.
    area, length
        ``(c,)`` mm2, negative for holes, and mm.
    low, high
        ``(c, 2)`` mm, corners of the boxes around them.
    """

    points: Floats
    first: Int64s
    area: Floats
    length: Floats
    low: Floats
    high: Floats

    def points_of(self, contour: int) -> Floats:
        """Return the points of a contour, ``(n, 2)`` mm."""
        return self.points[self.first[contour] : self.first[contour + 1]]


def _contours_of(region: "CrossSection") -> _SectionContours:
    polygons: Sequence[Floats] = [np.asarray(polygon) for polygon in region.to_polygons()]
    points = np.concatenate(polygons)
    first = np.cumsum([0, *(len(polygon) for polygon in polygons)])
    starts = first[:-1]
    following = np.arange(1, len(points) + 1)
    following[first[1:] - 1] = starts
    step = points[following] - points
    cross = points[:, 0] * step[:, 1] - points[:, 1] * step[:, 0]
    return _SectionContours(
        points,
        first,
        np.add.reduceat(cross, starts) / 2.0,
        np.add.reduceat(np.hypot(step[:, 0], step[:, 1]), starts),
        np.minimum.reduceat(points, starts),
        np.maximum.reduceat(points, starts),
    )


def _have_no_holes(contours: _SectionContours) -> Bools:
    """Tell which contours are certainly no holes and have none."""
    found = contours.area > 0.0
    for hole in np.flatnonzero(~found):
        low, high = contours.low[hole], contours.high[hole]
        found &= ~((contours.low <= low) & (contours.high >= high)).all(axis=1)
    return found


def _keys(contours: _SectionContours) -> list[bytes]:
    """Return the shapes of contours: their vertices on a grid, from the lowest and leftmost on."""
    starts, count = contours.first[:-1], np.diff(contours.first)
    owner = np.repeat(np.arange(len(count)), count)
    grid = np.floor((contours.points - contours.low[owner]) / _GRID + _PHASE).astype(np.int64)
    code = grid[:, 0] * (1 << 31) + grid[:, 1]
    lowest = np.flatnonzero(code == np.minimum.reduceat(code, starts)[owner])
    head = lowest[np.unique(owner[lowest], return_index=True)[1]]
    turned = np.arange(len(code)) - starts[owner] + (head - starts)[owner]
    data = code[starts[owner] + turned % count[owner]].tobytes()
    ends = (contours.first * code.itemsize).tolist()
    return [data[a:b] for a, b in zip(ends[:-1], ends[1:], strict=True)]


def _near(contours: _SectionContours, chosen: Bools, margin: float) -> Bools:
    """Tell which contours are in or near the boxes around chosen ones."""
    near = chosen.copy()
    for row in np.flatnonzero(chosen):
        low, high = contours.low[row] - margin, contours.high[row] + margin
        near |= ((contours.low <= high) & (contours.high >= low)).all(axis=1)
    return near


def _owners(region: "CrossSection", start: Floats, margin: float) -> Bools:
    """Tell in which places of a column something of a region is."""
    found = np.zeros(len(start), np.bool_)
    height = [polygon[0][1] for polygon in region.to_polygons()]
    found[np.searchsorted(start - margin, height, side="right") - 1] = True
    return found
