"""Subdivide overhang regions at the limits up to which the part carries them."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.subdivision import SubdividedMesh, bisect
from amprep.geometry.overhangs.carried.points import Carrier

_FINEST, _COARSEST = 0.25, 0.6
"""Radius (mm) of triangles that are not split, and of those that are split whatever their points say."""

_SMALL = 0.1
"""Radius (mm) of triangles that are judged by their middles."""

_MOST_ROUNDS = 60
_INWARDS = 0.98
"""Position of test points near corners, as a fraction of the way from the middle of the triangle."""

# Strategy. The distance from the nearest anchor changes by at most 1 mm a mm, so a triangle whose middle is farther
# from the limit than its corners are from its middle is decided as a whole: large flats need few triangles. The
# others are bisected until their middles and corners agree at a radius below `_COARSEST`, or down to `_FINEST`,
# where one point that is not carried decides. Then no carried piece holds a point that needs support and is farther
# than about `_FINEST` from the next test point.


class Pieces(NamedTuple):
    """Triangles into which the faces of regions are subdivided.

    Attributes
    ----------
    points, triangles
        ``(n, 3)`` mm, ``(k, 3)``; the points given come first.
    face
        ``(k,)`` face of the regions that each is on.
    needed
        ``(k,)`` bool, whether it needs support.
    """

    points: Floats
    triangles: Int64s
    face: Int64s
    needed: Bools


def subdivide_at_limits(carrier: Carrier, points: Floats, triangles: Int64s, chosen: Bools) -> Pieces:
    """Subdivide the chosen faces of regions, and tell which pieces need support.

    Parameters
    ----------
    carrier
        The faces and the limits.
    points, triangles
        ``(n, 3)`` mm, and the corners ``(m, 3)`` of the faces of the regions.
    chosen
        ``(m,)`` bool: faces to judge.
    """
    face = np.flatnonzero(chosen)
    mesh = SubdividedMesh(points, triangles[face].astype(np.int32), face)
    decided, needed = np.zeros(len(face), np.bool_), np.zeros(len(face), np.bool_)
    for _ in range(_MOST_ROUNDS):
        open_ = np.flatnonzero(~decided)
        is_split, needs = _judge(carrier, mesh.vertices[mesh.triangles[open_]], mesh.parent[open_])
        needed[open_], decided[open_] = needs, ~is_split
        if not is_split.any():
            break
        finer = bisect(mesh, ~decided)
        from_ = finer.parent
        decided, needed = decided[from_], needed[from_]
        mesh = SubdividedMesh(finer.vertices, finer.triangles, mesh.parent[from_])
    return Pieces(mesh.vertices, mesh.triangles.astype(np.int64), mesh.parent, needed)


def _judge(carrier: Carrier, corners: Floats, face: Int64s) -> tuple[Bools, Bools]:
    """Tell which triangles ``(n, 3, 3)`` to split, and which need support (those to split: perhaps)."""
    middle = corners.mean(axis=1)
    radius = np.linalg.norm((corners - middle[:, None])[:, :, :2], axis=2).max(axis=1)
    spots = carrier.spots(middle, face)
    needed = spots.least - radius > carrier.farthest(face)
    split = np.zeros(len(face), np.bool_)
    left = np.flatnonzero(~needed)
    ledges = np.zeros(len(face))
    ledges[left] = carrier.ledges(spots.take(left), in_order=True)
    beyond = ledges[left] + radius[left] > carrier.limits.ledge
    split[left] = beyond & (radius[left] > _COARSEST)
    left = left[(beyond | np.isfinite(carrier.climb[face[left]])) & ~split[left]]
    needed[left] = ~carrier.carries(spots.take(left), ledges[left])
    left = left[radius[left] > _SMALL]
    tests = middle[left, None] + _INWARDS * (corners[left] - middle[left, None])
    at = carrier.carries(carrier.spots(tests.reshape(-1, 3), np.repeat(face[left], 3))).reshape(-1, 3)
    mixed = (at != ~needed[left, None]).any(axis=1)
    split[left[mixed & (radius[left] > _FINEST)]] = True
    needed[left[mixed]] = True
    return split, needed
