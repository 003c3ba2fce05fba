"""Enclose points by a convex polyhedron of few corners."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.bounding.convex.prepared import extreme_points
from amprep.geometry.bounding.grid_cuts.directions import sphere_directions

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull

# Strategy. Most points are inside the hull of the extreme points in some directions, and with a few others it is exact.
# If it has too many corners, or if many points are outside, because the piece is round, some of its planes are kept and
# moved out to the points. A polyhedron of f faces has at most 2 f - 4 corners. Planes of large faces and those farthest
# from all chosen ones come first, so that the planes around a round piece are evenly spread.

MOST_CORNERS = 80
"""Largest number of corners of a piece."""

MOST_FACES = MOST_CORNERS // 2 + 2
"""Number of faces that never have more corners."""

FEW = 50
"""All points outside the hull of some are added to them if they are so few, and else the farthest only."""

ROUNDING = 1e-6
"""Distance (mm) that pieces are moved outward for the rounding of their corners."""

FLAT = 1e-3
"""A piece is flat if its middle is nearer to one of its faces than this fraction of its size."""

COPLANAR = 1e-6
"""Difference of unit normals up to which faces are in one plane."""


def enclosing_corners(points: Floats, extreme: Floats, outward: float) -> Floats:
    """Return the corners ``(k, 3)`` of a convex polyhedron that contains points, at most `MOST_CORNERS` if not flat.

    Parameters
    ----------
    points, extreme
        ``(n, 3)`` and ``(m, 3)`` mm: all points, and some that are extreme.
    outward
        Distance (mm) of the points from its faces at least.
    """
    hull, outside = _hull(extreme), points
    if hull is not None:
        outside = points[_outside(points, hull.equations)]
    if hull is not None and len(outside) > 0:
        added = _farthest(outside, hull.equations)
        extreme = np.concatenate((extreme, outside[added]))
        outside = np.delete(outside, added, axis=0)
        hull = _hull(extreme)
    if hull is None:
        return _thickened(extreme_points(np.concatenate((points, extreme))), outward)
    corners = extreme[hull.vertices]
    if len(outside) > 0 or len(corners) > MOST_CORNERS:
        areas = _areas(extreme[hull.simplices])
        corners = _few_corners(np.concatenate((corners, outside)), hull.equations[:, :3], areas)
    middle = corners.mean(axis=0)
    inner = -float((hull.equations[:, :3] @ middle + hull.equations[:, 3]).max())
    if inner < FLAT * float(np.linalg.norm(corners - middle, axis=1).max()):
        return _thickened(corners, outward)
    return np.asarray(middle + (corners - middle) * (1.0 + (outward + ROUNDING) / inner))


def enclosing_hull(points: Floats) -> Floats:
    """Return the corners ``(k, 3)`` of a convex polyhedron that contains points ``(n, 3)`` mm."""
    points = points.copy()  # of read-only points the kernel would be compiled once more
    low, size = points.min(axis=0), np.maximum(np.ptp(points, axis=0), 1e-9)
    products = ((points - low) / size) @ sphere_directions().normals.T
    extreme = np.unique(np.concatenate((products.argmax(axis=0), products.argmin(axis=0))))
    return enclosing_corners(points, points[extreme], 0.0)


def _hull(points: Floats) -> "ConvexHull | None":
    from scipy.spatial import ConvexHull, QhullError

    try:
        return ConvexHull(points)
    except (QhullError, ValueError):
        return None


def _outside(points: Floats, planes: Floats) -> Bools:
    """Tell which points are outside a hull by more than half of `ROUNDING`."""
    from amprep.kernels.bounding.grid_cuts.extremes import mark_outside

    outside = np.empty(len(points), np.bool_)
    mark_outside(points, np.unique(np.round(planes, 9), axis=0), ROUNDING / 2.0, outside)
    return outside


def _farthest(points: Floats, planes: Floats) -> Int64s:
    """Return the points that are farthest outside of each plane; all if they are few."""
    if len(points) <= FEW:
        return np.arange(len(points))
    return np.unique((points @ planes[:, :3].T + planes[:, 3]).argmax(axis=0))


def _thickened(corners: Floats, outward: float) -> Floats:
    """Return the corners of the hull of cubes around points."""
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return extreme_points((corners[:, None] + (outward + ROUNDING) * cube).reshape(-1, 3))


def _areas(triangles: Floats) -> Floats:
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.asarray(np.linalg.norm(across, axis=1))


def _few_corners(points: Floats, normals: Floats, area: Floats) -> Floats:
    """Return the corners of a polyhedron of few faces that contains points, or those of their hull if that fails."""
    from scipy.spatial import HalfspaceIntersection, QhullError

    key = np.round(normals / COPLANAR).astype(np.int64)
    _, first, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
    weight: Floats = np.concatenate((np.zeros(6), np.bincount(which.ravel(), area))).astype(np.float64)
    normals = np.concatenate((np.eye(3), -np.eye(3), normals[first]))
    chosen = normals[_spread(normals, weight)]
    offsets = (points @ chosen.T).max(axis=0)
    try:
        found = HalfspaceIntersection(np.column_stack((chosen, -offsets)), points.mean(axis=0)).intersections
    except (QhullError, ValueError):
        return extreme_points(points)
    return extreme_points(np.asarray(found if np.isfinite(found).all() else points))


def _spread(normals: Floats, area: Floats) -> Int64s:
    """Return the normals to the axes, the first six, and others of large faces that are far from all before."""
    chosen = list(range(6))
    distance = 1.0 - (normals @ normals[:6].T).max(axis=1)
    while len(chosen) < min(MOST_FACES, len(normals)):
        best = int((area * distance).argmax())
        chosen.append(best)
        distance = np.minimum(distance, 1.0 - normals @ normals[best])
    return np.array(chosen)
