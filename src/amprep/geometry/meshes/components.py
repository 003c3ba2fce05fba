"""Pieces of a solid that lie wholly in a region, held by nothing outside it."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.shells import Shells, measure_shells
from amprep.geometry.meshes.topology import drop_unused_vertices

CRUMB = 1e-4
"""mm3; what booleans on rounded coordinates may leave behind, and nobody misses."""

_INWARD = 1e-3
"""mm; how far below the surface a point stands for what is there."""


class DetachedSplit(NamedTuple):
    """What stays of a solid, what is let go of it, and how many pieces that is, crumbs aside."""

    kept: MeshArrays
    islands: MeshArrays
    number: int


def drop_detached(points: Floats, triangles: Int64s, region: MeshArrays, whole: MeshArrays) -> DetachedSplit:
    """Let go of the pieces that lie wholly in the region.

    Where a piece of the `whole` lay wholly in the region itself, the largest that is left of it stays.

    Parameters
    ----------
    points, triangles
        A closed solid ``(n, 3)`` mm, ``(m, 3)``; shells of negative volume are voids in its pieces.
    region, whole
        Closed solids: the region, and what there was before.
    """
    shells = measure_shells(points, triangles)
    corners = points[triangles]
    outward = shells.volume > 0.0
    loose = outward & ~_reaching_out(corners, shells.label, len(shells.volume), region)
    loose[_largest_each(points, triangles, shells, loose, region, whole)] = False
    if not loose.any():
        return DetachedSplit((points, triangles), (np.empty((0, 3)), np.empty((0, 3), np.int64)), 0)
    gone = loose[shells.label]
    islands = drop_unused_vertices(points, triangles[gone])
    first = np.unique(shells.label, return_index=True)[1]
    voids = np.flatnonzero(~outward)
    loose[voids] = _within(points[triangles[first[voids], 0]], islands)
    count = int((loose & (shells.volume > CRUMB)).sum())
    gone = loose[shells.label]
    return DetachedSplit(
        drop_unused_vertices(points, triangles[~gone]), drop_unused_vertices(points, triangles[gone]), count
    )


def count_components(points: Floats, triangles: Int64s) -> int:
    """Return how many pieces a closed solid has, crumbs and voids aside."""
    return int((measure_shells(points, triangles).volume > CRUMB).sum()) if len(triangles) else 0


def genus_of(points: Floats, triangles: Int64s) -> int:
    """Return how many handles all surfaces of a closed mesh have, each vertex of which is used by one of them."""
    shells = len(measure_shells(points, triangles).volume)
    used = len(np.unique(triangles))
    euler = used - len(triangles) // 2  # of closed triangles 3 / 2 as many edges as triangles
    return shells - euler // 2


def _reaching_out(corners: Floats, label: Int64s, count: int, region: MeshArrays) -> Bools:
    """Tell which shells have solid outside the region just below their surface, ``(count,)``."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    fair = np.flatnonzero(length > 1e-9)
    below = corners[fair].mean(axis=1) - _INWARD * normal[fair] / length[fair, None]
    out = fair[~_within(below, region)]
    return np.asarray(np.bincount(label[out], minlength=count) > 0)


def _largest_each(
    points: Floats, triangles: Int64s, shells: Shells, loose: Bools, region: MeshArrays, whole: MeshArrays
) -> Int64s:
    """Return the largest loose shell in each piece of the whole that lies in the region altogether."""
    if not loose.any():
        return np.empty(0, np.int64)
    before = measure_shells(*whole)
    corners = whole[0][whole[1]]
    covered = (before.volume > CRUMB) & ~_reaching_out(corners, before.label, len(before.volume), region)
    number = np.flatnonzero(loose)
    first = np.unique(shells.label, return_index=True)[1][number]
    middle = _below(points[triangles[first]])
    found = []
    for piece in np.flatnonzero(covered):
        within = _within(middle, drop_unused_vertices(whole[0], whole[1][before.label == piece]))
        if within.any():
            found.append(number[within][shells.volume[number[within]].argmax()])
    return np.array(found, np.int64)


def _below(corners: Floats) -> Floats:
    """Return a point just below the middle of each triangle."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    return np.asarray(corners.mean(axis=1) - _INWARD * normal)


def _within(points: Floats, solid: MeshArrays) -> Bools:
    return inside(points, solid[0], solid[1].astype(np.int32))
