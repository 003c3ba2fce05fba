"""The outlines of horizontal sections, simplified: of one section, or of many at once."""

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.slicing.contours import PlaneContours
from amprep.geometry.supports.footprints import box, union_of
from amprep.kernels.supports.outlines import PlaneOutlines

if TYPE_CHECKING:
    from manifold3d import CrossSection

SMOOTH = 0.003
"""Distance (mm) by which outlines are simplified."""

_POINTS = 128
"""Points that are compared with all contours at once."""


class Contours(NamedTuple):
    """The contours of a region.

    Attributes
    ----------
    contours
        Points ``(n, 2)`` mm of each, the region to their left.
    low, high
        ``(k, 2)`` mm, corners of their boxes.
    """

    contours: list[Floats]
    low: Floats
    high: Floats

    def whole(self) -> "CrossSection":
        """Return the region."""
        from manifold3d import CrossSection, FillRule

        return CrossSection(self.contours, FillRule.Positive)

    def inside(self, low: Floats, high: Floats) -> "CrossSection":
        """Return the region inside the union of rectangles with the corners ``(n, 2)`` mm."""
        from manifold3d import CrossSection, FillRule

        meets = np.all((self.low[:, None] < high) & (self.high[:, None] > low), axis=2)
        chosen = [self.contours[each] for each in np.flatnonzero(np.any(meets, axis=1)).tolist()]
        if not chosen:
            return CrossSection()
        boxes = union_of([box(*each) for each in zip(low, high, strict=True)])
        return CrossSection(chosen, FillRule.Positive) ^ boxes

    def cover(self, points: Floats) -> Bools:
        """Tell which points ``(n, 2)`` mm are inside the region, by winding numbers."""
        found = np.zeros(len(points), np.bool_)
        if not self.contours:
            return found
        start = np.concatenate(self.contours)
        end = np.concatenate([np.roll(each, -1, axis=0) for each in self.contours])
        for first in range(0, len(points), _POINTS):
            x, y = (each[:, None] for each in points[first : first + _POINTS].T)
            side = (end - start)[:, 0] * (y - start[:, 1]) - (end - start)[:, 1] * (x - start[:, 0])
            up = (start[:, 1] <= y) & (end[:, 1] > y) & (side > 0.0)
            down = (start[:, 1] > y) & (end[:, 1] <= y) & (side < 0.0)
            found[first : first + _POINTS] = up.sum(axis=1) > down.sum(axis=1)
        return found


def contours_of(region: "CrossSection") -> Contours:
    """Return the outlines of a region, simplified by at most 0.003 mm."""
    return _with_boxes([np.asarray(contour) for contour in region.simplify(SMOOTH).to_polygons()])


def plane_outlines(sliced: PlaneContours) -> PlaneOutlines:
    """Return the outlines of all sections of a mesh, simplified by at most 0.003 mm."""
    from amprep.kernels.slicing.straight import keep_bends

    order = np.argsort(sliced.plane, kind="stable")
    sizes = np.diff(sliced.first)[order]
    first = np.append(0, np.cumsum(sizes))
    points = sliced.points[np.arange(first[-1]) + np.repeat(sliced.first[order] - first[:-1], sizes)]
    kept = np.zeros(len(points), np.bool_)
    keep_bends(points, first, SMOOTH, kept)
    sizes = np.diff(np.append(0, np.cumsum(kept))[first])
    has_area = sizes > 2
    points, sizes = points[kept & np.repeat(has_area, np.diff(first))], sizes[has_area]
    begin = np.searchsorted(sliced.plane[order][has_area], np.arange(len(sliced.heights) + 1))
    return PlaneOutlines(points, np.append(0, np.cumsum(sizes)), begin)


def as_outlines(region: Contours) -> PlaneOutlines:
    """Return the contours of one region as the outlines in a plane."""
    sizes = [len(contour) for contour in region.contours]
    points = np.concatenate(region.contours) if sizes else np.empty((0, 2))
    return PlaneOutlines(points, np.cumsum([0, *sizes]), np.array([0, len(sizes)]))


def contours_in(outlines: PlaneOutlines, plane: int) -> Contours:
    """Return the contours in one of the planes of outlines."""
    own = outlines.first[outlines.begin[plane] : outlines.begin[plane + 1] + 1].tolist()
    return _with_boxes([outlines.points[start:end] for start, end in pairwise(own)])


def _with_boxes(contours: Sequence[Floats]) -> Contours:
    """Return contours with their boxes."""
    if not contours:
        return Contours([], np.empty((0, 2)), np.empty((0, 2)))
    points, first = np.concatenate(contours), np.cumsum([0, *map(len, contours[:-1])])
    return Contours(list(contours), np.minimum.reduceat(points, first), np.maximum.reduceat(points, first))
