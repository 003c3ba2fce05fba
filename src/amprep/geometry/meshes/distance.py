"""How far bodies are apart and how deep they meet: boxes, solids, bare triangles."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats

if TYPE_CHECKING:
    from manifold3d import Manifold


def near_pairs(lo: Floats, hi: Floats, distance: float) -> list[tuple[int, int]]:
    """Return the pairs i < j of boxes ``(n, 3)`` whose gap along every axis is less than `distance`.

    With `distance` 0 these are the pairs that overlap; a negative one leaves out shallow overlaps.
    """
    pairs: list[tuple[int, int]] = []
    for i in range(len(lo) - 1):
        near = (lo[i + 1 :] - hi[i] < distance) & (lo[i] - hi[i + 1 :] < distance)
        pairs += [(i, i + 1 + int(j)) for j in np.flatnonzero(near.all(axis=1))]
    return pairs


def box_distance(lo: Floats, hi: Floats, other_lo: Floats, other_hi: Floats) -> float:
    """Return the distance of two sets of boxes ``(k, 3)``, ``(m, 3)``; when they overlap, less the depth.

    The depth of an overlap is the shortest way along an axis that ends it.
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
    """Return the thickness of the thickest piece of a solid: twice its volume over its surface, mm.

    Of a thin slab, such as what two bodies share that touch, that is the slab's thickness.
    """
    thickest = 0.0
    for piece in solid.decompose():
        area = piece.surface_area()
        if area > 0.0:
            thickest = max(thickest, 2.0 * abs(piece.volume()) / area)
    return thickest


def solid_distance(solid: "Manifold", other: "Manifold", limit: float) -> float:
    """Return the distance of two solids, at most `limit`; if they overlap, less the `thickness` shared."""
    shared = thickness(solid ^ other)
    if shared > 0.0 or limit <= 0.0:
        return -shared
    return float(solid.min_gap(other, limit))


def triangle_distance(corners: Floats, other: Floats, limit: float) -> float:
    """Return the distance of two sets of triangles ``(n, 3, 3)``, at most `limit`; if crossing, less depth.

    The depth of a crossing is how far the edge would have to be drawn back, or the pierced triangle trimmed.
    Triangles that enclose others without touching them do not cross them.
    """
    from amprep.kernels.meshes.distance import least_distance

    lo, hi = corners.min(axis=1), corners.max(axis=1)
    other_lo, other_hi = other.min(axis=1), other.max(axis=1)
    reach = max(limit, 0.0) + 1e-9
    near = ((lo <= other_hi.max(axis=0) + reach) & (hi >= other_lo.min(axis=0) - reach)).all(axis=1)
    other_near = ((other_lo <= hi.max(axis=0) + reach) & (other_hi >= lo.min(axis=0) - reach)).all(axis=1)
    if not near.any() or not other_near.any():
        return max(limit, 0.0)
    chosen = np.flatnonzero(other_near)
    chosen = chosen[np.argsort(other_lo[chosen, 0], kind="stable")]
    widest = float((other_hi[chosen, 0] - other_lo[chosen, 0]).max())
    one, two = np.ascontiguousarray(corners[near]), np.ascontiguousarray(other[chosen])
    return float(least_distance(one, two, widest, max(limit, 0.0)))
