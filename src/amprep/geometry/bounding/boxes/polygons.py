"""Convex polygons, or small boxes: what is to be covered, and what of it boxes leave uncovered."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, Ints


class ConvexPolygons(NamedTuple):
    """Convex polygons in space, or boxes that contain them.

    Attributes
    ----------
    points
        ``(n, 3)`` mm; each is a corner of a polygon.
    corners
        ``(m,)`` index of each corner in `points`, one polygon after another, in order around each.
    first
        ``(p + 1,)`` index in `corners` of the first corner of each polygon, and m.
    solid
        Whether each polygon stands for a box, and has its least and its greatest corner instead.
    """

    points: Floats
    corners: Int64s
    first: Int64s
    solid: bool = False

    @property
    def bounds(self) -> Floats:
        """``(6,)`` least and greatest corner; inf and -inf without polygons."""
        return enclosing(self.points)


def enclosing(points: Floats) -> Floats:
    """Return the enclosing box of points, ``(6,)``; inf and -inf without points."""
    columns = points.T
    low = [column.min(initial=np.inf) for column in columns]  # far faster than rows of three
    return np.array(low + [column.max(initial=-np.inf) for column in columns])


def polygons_of(vertices: Floats, triangles: Ints) -> ConvexPolygons:
    """Return the triangles of a mesh as polygons; vertices in no triangle are left out."""
    corners = np.array(triangles.ravel(), np.int64)
    used = np.zeros(len(vertices), np.bool_)
    used[corners] = True
    if not used.all():
        corners, vertices = (np.cumsum(used) - 1)[corners], vertices[used]
    return ConvexPolygons(
        np.ascontiguousarray(vertices, np.float64), corners, np.arange(0, len(corners) + 1, 3)
    )


def boxes_as_polygons(boxes: Floats) -> ConvexPolygons:
    """Return boxes ``(k, 6)``, to be covered themselves."""
    count = 2 * len(boxes)
    points = np.ascontiguousarray(boxes, np.float64).reshape(count, 3)
    return ConvexPolygons(points, np.arange(count), np.arange(0, count + 1, 2), solid=True)


def outside(polygons: ConvexPolygons, boxes: Floats) -> ConvexPolygons:
    """Return what is left of polygons outside the union of closed boxes ``(k, 6)``.

    The pieces are cut at the faces of the boxes exactly: a corner that a face cuts has its very coordinate.
    """
    from amprep.kernels.bounding.boxes.polygons import MOST_CORNERS, clip_outside

    if not len(boxes):
        return polygons
    room, pieces = 1, -1
    boxes = np.ascontiguousarray(boxes, np.float64)
    while pieces < 0:
        points = np.empty((room * (len(polygons.corners) + 32 * MOST_CORNERS), 3))
        ends = np.empty(room * (len(polygons.first) + 256), np.int64)
        pieces = clip_outside(*polygons, boxes, points, ends)
        room *= 2
    count = ends[pieces]
    return ConvexPolygons(points[:count].copy(), np.arange(count), ends[: pieces + 1].copy(), polygons.solid)
