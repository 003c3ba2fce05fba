"""Contours without the points on straight lines, ordered by plane, and the pieces of section that they bound."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.slicing.contours import PlaneContours

if TYPE_CHECKING:
    from manifold3d import CrossSection


class SectionOutlines(NamedTuple):
    """Contours, the inside to their left, that bound pieces of sections.

    Attributes
    ----------
    points, first
        ``(n, 2)`` mm, points of all contours, those of contour c from ``first[c]`` up to ``first[c + 1]``.
    plane
        ``(c,)`` plane of each contour, ascending.
    area, length
        ``(c,)`` mm2, negative for holes, and mm.
    low, high
        ``(c, 2)`` mm, corners of the boxes around them.
    border
        ``(c,)`` outer contour of the piece that a contour bounds: itself, or that around a hole; -1 where a hole is in
        none.
    """

    points: Floats
    first: Int64s
    plane: Int64s
    area: Floats
    length: Floats
    low: Floats
    high: Floats
    border: Int64s

    def points_of(self, contour: int) -> Floats:
        """Return the points of a contour, ``(n, 2)`` mm."""
        return self.points[self.first[contour] : self.first[contour + 1]]

    def region_of(self, contours: Int64s) -> "CrossSection":
        """Return the region that some contours of one plane enclose."""
        from manifold3d import CrossSection, FillRule

        return CrossSection([self.points_of(each) for each in contours.tolist()], FillRule.Positive)


def outlines_of(contours: PlaneContours, tolerance: float) -> SectionOutlines:
    """Return contours without the points within a tolerance (mm) of straight lines; contours that are lines go, too."""
    from amprep.kernels.slicing.outlines import find_borders, straighten

    kept, first = np.empty_like(contours.points), np.empty_like(contours.first)
    straighten(contours.points, contours.first, tolerance, kept, first)
    order = np.argsort(contours.plane, kind="stable")
    order = order[np.diff(first)[order] > 2]
    count = np.diff(first)[order]
    begins = np.append(0, np.cumsum(count))
    points = kept[np.arange(begins[-1]) + np.repeat(first[order] - begins[:-1], count)]
    low, high, area, length = _measured(points, begins)
    plane, border = contours.plane[order], np.empty(len(order), np.int64)
    find_borders(points, begins, plane, area, np.hstack([low, high]), border)
    return SectionOutlines(points, begins, plane, area, length, low, high, border)


def _measured(points: Floats, first: Int64s) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the boxes, the areas and the lengths of contours."""
    if not len(points):
        return np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty(0)
    starts, owner = first[:-1], np.repeat(np.arange(len(first) - 1), np.diff(first))
    following = np.arange(1, len(points) + 1)
    following[first[1:] - 1] = starts
    own = points - points[starts][owner]
    step = points[following] - points
    cross = own[:, 0] * step[:, 1] - own[:, 1] * step[:, 0]
    return (
        np.minimum.reduceat(points, starts),
        np.maximum.reduceat(points, starts),
        np.add.reduceat(cross, starts) / 2.0,
        np.add.reduceat(np.hypot(step[:, 0], step[:, 1]), starts),
    )
