"""Enclose points by a convex polyhedron of few corners."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.bounding.convex.prepared import extreme_points

# Strategy. Most points are inside the hull of the extreme points in some directions. Only the others are given to
# Qhull, which finds the exact hull. If that has too many corners, some of its planes are kept: a polyhedron of f
# faces has at most 2 f - 4 corners. Planes of large faces and those farthest from all chosen ones come first, so that
# the planes around a round piece are evenly spread. The polyhedron contains the hull because each plane does.

MOST_CORNERS = 40
"""Largest number of corners of a piece."""

MOST_FACES = MOST_CORNERS // 2 + 2
"""Number of faces that never have more corners."""

ROUNDING = 1e-6
"""Distance (mm) that pieces are moved outward for the rounding of their corners."""

FLAT = 1e-3
"""A piece is flat if this fraction of its size is more than the distance of its middle from its faces."""

COPLANAR = 1e-6
"""Difference of unit normals up to which faces are in one plane."""


def hull_of(points: Floats, extreme: Floats) -> Floats:
    """Return the corners ``(k, 3)`` of the convex hull of points, of which some extreme ones are known.

    Points outside by less than half of `ROUNDING` may be left out.
    """
    from scipy.spatial import ConvexHull, QhullError

    from amprep.kernels.bounding.grid_cuts.extremes import mark_outside

    try:
        planes = ConvexHull(extreme).equations
    except (QhullError, ValueError):
        return extreme_points(np.concatenate((points, extreme)))
    outside = np.empty(len(points), np.bool_)
    different = np.unique(np.round(planes, 9), axis=0)
    mark_outside(points, different, ROUNDING / 2.0, outside)
    return extreme_points(np.concatenate((extreme, points[outside])))


def enclosing_corners(points: Floats, extreme: Floats, outward: float) -> Floats:
    """Return the corners ``(k, 3)`` of a convex polyhedron that contains points, at most `MOST_CORNERS` if not flat.

    Parameters
    ----------
    points, extreme
        ``(n, 3)`` and ``(m, 3)`` mm: all points, and some that are extreme.
    outward
        Distance (mm) of the points from its faces at least.
    """
    from scipy.spatial import ConvexHull, QhullError

    corners = hull_of(points, extreme)
    try:
        hull = ConvexHull(corners)
    except (QhullError, ValueError):
        return _thickened(corners, outward)
    if len(corners) > MOST_CORNERS:
        corners = _fewer_corners(corners, hull.equations[:, :3], _areas(corners[hull.simplices]))
    middle = corners.mean(axis=0)
    inner = float(-(hull.equations[:, :3] @ middle + hull.equations[:, 3]).max())
    if inner < FLAT * float(np.linalg.norm(corners - middle, axis=1).max()):
        return _thickened(corners, outward)
    return np.asarray(middle + (corners - middle) * (1.0 + (outward + ROUNDING) / inner))


def _thickened(corners: Floats, outward: float) -> Floats:
    """Return the corners of the hull of cubes around points."""
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return extreme_points((corners[:, None] + (outward + ROUNDING) * cube).reshape(-1, 3))


def _areas(triangles: Floats) -> Floats:
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.asarray(np.linalg.norm(across, axis=1))


def _fewer_corners(corners: Floats, normals: Floats, area: Floats) -> Floats:
    """Return the corners of a polyhedron of some planes of a hull, or its corners if that fails."""
    from scipy.spatial import HalfspaceIntersection, QhullError

    key = np.round(normals / COPLANAR).astype(np.int64)
    _, first, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
    weight: Floats = np.concatenate((np.zeros(6), np.bincount(which.ravel(), area))).astype(np.float64)
    normals = np.concatenate((np.eye(3), -np.eye(3), normals[first]))
    chosen = normals[_spread(normals, weight)]
    offsets = (corners @ chosen.T).max(axis=0)
    middle = corners.mean(axis=0)
    try:
        found = HalfspaceIntersection(np.column_stack((chosen, -offsets)), middle).intersections
    except (QhullError, ValueError):
        return corners
    return extreme_points(np.asarray(found)) if np.isfinite(found).all() else corners


def _spread(normals: Floats, area: Floats) -> Int64s:
    """Return the normals to the axes, the first six, and others of large faces that are far from all before."""
    chosen = list(range(6))
    distance = 1.0 - (normals @ normals[:6].T).max(axis=1)
    while len(chosen) < min(MOST_FACES, len(normals)):
        best = int((area * distance).argmax())
        chosen.append(best)
        distance = np.minimum(distance, 1.0 - normals @ normals[best])
    return np.array(chosen)
