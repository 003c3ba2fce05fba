"""Recognise pieces of sections that keep the least wall and the least contact for certain.

Strategy. Sections of supports consist of few shapes that repeat, within a section and from plane to plane. A piece (an
outer contour with its holes), moved to the origin and rounded to `_GRID`, is a shape. The first piece of each shape is
judged alone, with a margin for the rounding: a disc wider than the least wall fits in it, such discs leave no fin, and
its area is large enough. If the vertices of another piece differ by at most the margin, so do all points of its border,
and it keeps the limits, too: discs that fit elsewhere can only make fins smaller. Pieces that fail this are left to the
exact judge, together with their neighbourhood; so are all pieces beside contours that cross themselves or are holes in
nothing, because those may take something away. New shapes are set out one above the other and judged by the same few
offsets; polygons side by side take far longer.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.slicing.outlines import SectionOutlines

if TYPE_CHECKING:
    from manifold3d import CrossSection

STRAIGHT = 0.0005
"""Distance (mm) from a straight line up to which vertices of contours are left out."""

_GRID = 0.004
"""Length (mm) to which contours are rounded."""

_MARGIN = 0.01
"""Distance (mm) by which borders of equal shapes may differ, with the errors of polygons for circles and contours."""

_PHASE = 0.37
"""Where the grid begins, so that round sizes are not between its points."""

_FINE, _COARSE = 16, 8
"""Sides of the polygons that stand for circles, when contours shrink and when they grow."""

_SAME_AREA = 1e-4
"""Difference of areas (mm2) from which a contour crosses itself."""

_TOGETHER = 500
"""Number of shapes that are judged by the same offsets."""

_Shape = tuple[bytes, ...]
"""The outer contour and the holes of a piece on the grid."""


class _Verdict(NamedTuple):
    """Whether a shape keeps the limits for certain, and whether its contours do not cross themselves."""

    is_right: bool
    is_simple: bool


_STRAY = _Verdict(is_right=False, is_simple=False)
"""Verdict on a hole in no outer contour."""


class Undecided(NamedTuple):
    """The contours that need an exact judge, and those near them with these, each ``(c,)`` bool."""

    own: Bools
    around: Bools


class KnownShapes:
    """The shapes of pieces that were judged, and their verdicts.

    Parameters
    ----------
    wall, contact
        Least wall (mm) and least area (mm2) of a section.
    reach
        Distance (mm) from the centres of discs of the least wall beyond which a piece has fins.
    """

    def __init__(self, wall: float, contact: float, reach: float) -> None:
        self.wall, self.contact, self.reach = wall, contact, reach
        self._verdicts: dict[_Shape, _Verdict] = {}

    def undecided(self, outlines: SectionOutlines) -> Undecided:
        """Return the contours of sections that may break a limit."""
        count = len(outlines.plane)
        if self.wall <= 0.0:
            return Undecided(np.ones(count, np.bool_), np.ones(count, np.bool_))
        pieces = _pieces(outlines)
        shapes = _shapes(outlines, pieces)
        fresh = {
            shape: piece for shape, piece in zip(shapes, pieces, strict=True) if shape not in self._verdicts
        }
        new = list(fresh.values())
        for at in range(0, len(new), _TOGETHER):
            self._judge(outlines, new[at : at + _TOGETHER], list(fresh)[at : at + _TOGETHER])
        verdicts = np.full((count, 2), False)
        outer = np.array([piece[0] for piece in pieces], np.int64)
        verdicts[outer] = np.array([self._verdicts[shape] for shape in shapes]).reshape(-1, 2)
        right, simple = np.where(outlines.border[:, None] >= 0, verdicts[outlines.border], _STRAY).T
        left = ~right | _near(outlines, ~simple, 0.0)
        left = left[outlines.border] | (outlines.border < 0)
        return Undecided(left, _near(outlines, left, self.reach + self.wall))

    def _judge(
        self, outlines: SectionOutlines, pieces: Sequence[list[int]], shapes: Sequence[_Shape]
    ) -> None:
        """Judge pieces by discs that fit in each of them alone; keep the verdicts on their shapes."""
        from manifold3d import CrossSection, FillRule, JoinType

        outer, gap = np.array([piece[0] for piece in pieces]), 2.0 * (self.reach + self.wall)
        depth = outlines.high[outer, 1] - outlines.low[outer, 1] + gap
        start = np.cumsum(depth) - depth
        moved = [
            outlines.points_of(row) - outlines.low[piece[0]] + (0.0, at)
            for piece, at in zip(pieces, start.tolist(), strict=True)
            for row in piece
        ]
        column = CrossSection(moved, FillRule.Positive)
        discs = column.offset(-self.wall / 2.0 - _MARGIN, JoinType.Round, 2.0, _FINE)
        fins = column - discs.offset(self.reach - 3.0 * _MARGIN, JoinType.Round, 2.0, _COARSE)
        has_disc, has_fin = (_areas(each, start, gap / 2.0) > 0.0 for each in (discs, fins))
        area, length = (
            np.array([float(each[piece].sum()) for piece in pieces])
            for each in (outlines.area, outlines.length)
        )
        simple = np.abs(_areas(column, start, gap / 2.0) - area) < _SAME_AREA
        right = simple & has_disc & ~has_fin & (area >= self.contact + _MARGIN * length)
        for shape, *verdict in zip(shapes, right.tolist(), simple.tolist(), strict=True):
            self._verdicts[shape] = _Verdict(*verdict)


def _pieces(outlines: SectionOutlines) -> list[list[int]]:
    """Return the contours of each piece, the outer one first."""
    inner = np.flatnonzero(outlines.border >= 0)
    is_hole = outlines.border[inner] != inner
    order = inner[np.lexsort((is_hole, outlines.border[inner]))]
    begins = np.flatnonzero(outlines.border[order] == order).tolist()
    contours = order.tolist()
    return [contours[a:b] for a, b in pairwise([*begins, len(contours)])]


def _shapes(outlines: SectionOutlines, pieces: Sequence[list[int]]) -> list[_Shape]:
    """Return the shapes of pieces: the vertices of contours on a grid that begins at the corner of the outer one."""
    owner = np.repeat(np.arange(len(outlines.plane)), np.diff(outlines.first))
    corner = outlines.low[np.maximum(outlines.border, 0)][owner]
    grid = np.floor((outlines.points - corner) / _GRID + _PHASE).astype(np.int64)
    code = grid[:, 0] * (1 << 31) + grid[:, 1]
    data, ends = code.tobytes(), (outlines.first * code.itemsize).tolist()
    keys = [data[a:b] for a, b in pairwise(ends)]
    return [(keys[piece[0]], *sorted(keys[hole] for hole in piece[1:])) for piece in pieces]


def _near(outlines: SectionOutlines, chosen: Bools, margin: float) -> Bools:
    """Tell which contours are in or near the boxes around chosen ones of their plane."""
    near = chosen.copy()
    begins = np.searchsorted(outlines.plane, outlines.plane, side="left").tolist()
    ends = np.searchsorted(outlines.plane, outlines.plane, side="right").tolist()
    for row in np.flatnonzero(chosen).tolist():
        own = slice(begins[row], ends[row])
        low, high = outlines.low[row] - margin, outlines.high[row] + margin
        near[own] |= ((outlines.low[own] <= high) & (outlines.high[own] >= low)).all(axis=1)
    return near


def _areas(column: "CrossSection", start: Floats, margin: float) -> Floats:
    """Return the area in each place of a column, mm2."""
    polygons = [np.asarray(polygon) for polygon in column.to_polygons()]
    if not polygons:
        return np.zeros(len(start))
    points, first = np.concatenate(polygons), np.cumsum([0, *map(len, polygons)])
    following = np.arange(1, len(points) + 1)
    following[first[1:] - 1] = first[:-1]
    step = points[following] - points
    cross = points[:, 0] * step[:, 1] - points[:, 1] * step[:, 0]
    place = np.searchsorted(start - margin, points[first[:-1], 1], side="right") - 1
    found: Floats = np.bincount(place, np.add.reduceat(cross, first[:-1]) / 2.0, len(start)).astype(
        np.float64
    )
    return found
