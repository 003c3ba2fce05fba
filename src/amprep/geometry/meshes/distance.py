"""Distance and penetration depth of boxes, solids and sets of triangles."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.meshes.box_tree import box_tree

if TYPE_CHECKING:
    from manifold3d import Manifold

    from amprep.kernels.meshes.distance import PlacedTree


def near_pairs(lo: Floats, hi: Floats, distance: float) -> list[tuple[int, int]]:
    """Return the pairs i < j of boxes whose distance along every axis is below a limit.

    Parameters
    ----------
    lo, hi
        ``(n, 3)`` mm, corners of the boxes.
    distance
        The limit, mm; with 0 the pairs that overlap are found, with a negative one those that overlap deeper than that.
    """
    pairs: list[tuple[int, int]] = []
    for i in range(len(lo) - 1):
        near = (lo[i + 1 :] - hi[i] < distance) & (lo[i] - hi[i + 1 :] < distance)
        pairs += [(i, i + 1 + int(j)) for j in np.flatnonzero(near.all(axis=1))]
    return pairs


def box_distance(lo: Floats, hi: Floats, other_lo: Floats, other_hi: Floats) -> float:
    """Return the distance of two sets of boxes, mm; if they overlap, minus the penetration depth.

    The penetration depth is the length of the shortest translation along an axis that separates two boxes.

    Parameters
    ----------
    lo, hi, other_lo, other_hi
        ``(k, 3)`` and ``(m, 3)`` mm, corners of the boxes.
    """
    gap = np.maximum(lo[:, None] - other_hi[None], other_lo[None] - hi[:, None])
    outside = np.linalg.norm(np.maximum(gap, 0.0), axis=2)
    return float(np.where(outside > 0.0, outside, gap.max(axis=2)).min())


def convex_solid(points: Floats) -> "Manifold":
    """Return the convex hull of points ``(n, 3)``."""
    from manifold3d import Manifold

    return Manifold.hull_points(np.ascontiguousarray(points))


def box_solids(lo: Floats, hi: Floats) -> "Manifold":
    """Return the union of boxes ``(k, 3)``."""
    from manifold3d import Manifold, OpType

    cubes = [Manifold.cube((b - a).tolist()).translate(a.tolist()) for a, b in zip(lo, hi, strict=True)]
    return Manifold.batch_boolean(cubes, OpType.Add)


def thickness(solid: "Manifold") -> float:
    """Return the greatest ratio of twice the volume to the surface area over the pieces of a solid, mm.

    For a thin slab, such as the intersection of two solids that touch, this is the thickness of the slab.
    """
    thickest = 0.0
    for piece in solid.decompose():
        area = piece.surface_area()
        if area > 0.0:
            thickest = max(thickest, 2.0 * abs(piece.volume()) / area)
    return thickest


def solid_distance(solid: "Manifold", other: "Manifold", limit: float) -> float:
    """Return the distance of two solids, at most `limit`, mm; if they overlap, minus the `thickness` of the overlap."""
    shared = thickness(solid ^ other)
    if shared > 0.0 or limit <= 0.0:
        return -shared
    return float(solid.min_gap(other, limit))


def triangle_distance(corners: Floats, other: Floats, limit: float) -> float:
    """Return the distance of two sets of triangles; if they intersect, minus the penetration depth.

    Where an edge pierces a triangle, the depth is the least distance from the point of intersection, measured normal to
    the triangle to an end of the edge, or in the triangle to its border. Triangles that enclose others without touching
    them do not intersect them.

    Parameters
    ----------
    corners, other
        ``(n, 3, 3)`` and ``(m, 3, 3)`` mm.
    limit
        Largest distance that is searched, mm; it is returned where the sets are farther apart.
    """
    most = max(limit, 0.0)
    return tree_distance(_tree_of(corners), _tree_of(other), most, -np.inf)


def tree_distance(one: "PlacedTree", other: "PlacedTree", limit: float, enough: float) -> float:
    """Return the distance of the triangles of two trees, at most `limit`; if they intersect, minus the depth.

    Parameters
    ----------
    one, other
        The triangles in the coordinates of the build.
    limit
        Largest distance that is searched, mm.
    enough
        A distance (mm) at which the search ends: the result is exact only if it is greater.
    """
    from amprep.kernels.meshes.distance import least_distance

    depth = int(np.log2(len(one.boxes) + 1) + np.log2(len(other.boxes) + 1)) + 2
    return float(least_distance(one, other, limit, enough, np.empty((depth, 2), np.int64)))


def _tree_of(corners: Floats) -> "PlacedTree":
    vertices = np.ascontiguousarray(corners, np.float64).reshape(-1, 3)
    return box_tree(vertices, np.arange(len(vertices)).reshape(-1, 3)).placed(vertices)
