"""Cut supports by horizontal planes, tell which contours of neighbouring planes are connected, and measure widths."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.slicing.contours import PlaneContours, SlicedMesh

_DIRECTIONS, _FINEST = 16, 0.01
"""Number of horizontal directions in which widths are measured, and the step (radians) at which the best is refined."""


@dataclass(frozen=True, eq=False)
class Slices:
    """The contours in which horizontal planes cut a closed mesh, and how they follow one another.

    Attributes
    ----------
    contours
        The contours.
    above
        ``(c,)`` outer contour above, where the surface up to the next plane connects exactly one outer contour with
        exactly one above; else -1.
    """

    contours: PlaneContours
    above: Int64s

    @property
    def is_outer(self) -> Bools:
        """Which contours are no holes, ``(c,)``."""
        return np.asarray(self.contours.area > 0.0)

    def heights_of(self, contours: Int64s) -> Floats:
        """Return the heights of some contours, mm."""
        return self.contours.heights[self.contours.plane[contours]]

    def points_of(self, contour: int) -> Floats:
        """Return the points of a contour, ``(n, 3)`` mm."""
        own = self.contours.points_of(contour)
        return np.hstack([own, np.full((len(own), 1), self.contours.heights[self.contours.plane[contour]])])

    def widths_of(self, contours: Int64s) -> Floats:
        """Return the least widths of the convex hulls of some contours, ``(k,)`` mm."""
        first = self.contours.first
        count = first[contours + 1] - first[contours]
        starts = np.cumsum(count) - count
        rows = np.arange(int(count.sum())) + np.repeat(first[contours] - starts, count)
        return _widths(self.contours.points[rows], starts)


def slices_of(mesh: SlicedMesh, heights: Floats) -> Slices:
    """Cut a closed mesh by horizontal planes at ascending heights, ``(k,)`` mm."""
    contours = mesh.contours(heights)
    return Slices(contours, _above(contours, *mesh.slabs(contours)))


def _widths(points: Floats, starts: Int64s) -> Floats:
    """Return the least width of the convex hull of each run of points, mm."""
    widths, best = np.full(len(starts), np.inf), np.zeros(len(starts))
    if not len(starts):
        return widths
    owner = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(points))))

    def measure(angles: Floats) -> None:
        along = points[:, 0] * np.cos(angles)[owner] + points[:, 1] * np.sin(angles)[owner]
        extent = np.maximum.reduceat(along, starts) - np.minimum.reduceat(along, starts)
        best[:] = np.where(extent < widths, angles, best)
        np.minimum(widths, extent, out=widths)

    step = np.pi / _DIRECTIONS
    for number in range(_DIRECTIONS):
        measure(np.full(len(starts), number * step))
    while step > _FINEST:
        step /= 2.0
        around = best.copy()
        measure(around - step)
        measure(around + step)
    return widths


def _above(contours: PlaneContours, below: Int64s, above: Int64s) -> Int64s:
    """Return the contour above each outer contour, -1 unless exactly one is above exactly one.

    `below` and `above` are the pieces of surface from each contour down and up to the next planes.
    """
    is_outer = contours.area > 0.0
    lower, upper = np.flatnonzero(is_outer & (above >= 0)), np.flatnonzero(is_outer & (below >= 0))
    size = int(max(above.max(initial=-1), below.max(initial=-1))) + 1
    alone = (np.bincount(above[lower], minlength=size) == 1) & (
        np.bincount(below[upper], minlength=size) == 1
    )
    upper_of = np.full(size, -1)
    upper_of[below[upper]] = upper
    found = np.full(len(is_outer), -1)
    found[lower] = np.where(alone[above[lower]], upper_of[above[lower]], -1)
    return found
