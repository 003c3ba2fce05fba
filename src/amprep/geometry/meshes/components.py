"""Disconnected components of a solid that are completely inside a region, and the genus of a mesh."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.shells import Shells, measure_shells
from amprep.geometry.meshes.topology import drop_unused_vertices

CRUMB = 1e-4
"""Volume (mm3) of the fragments that Booleans on rounded coordinates may leave; smaller ones are not counted."""

_INWARD = 1e-3
"""Inward offset (mm) at which sample points are taken."""


class DetachedSplit(NamedTuple):
    """The part of a solid that is kept, the detached components, and their number without fragments."""

    kept: MeshArrays
    detached: MeshArrays
    components: int


def drop_detached(points: Floats, triangles: Int64s, region: MeshArrays, whole: MeshArrays) -> DetachedSplit:
    """Separate the components of a filled solid that are completely inside the region, which nothing holds.

    If a component of the solid before filling was completely inside the region, the largest of its remains is kept.

    Parameters
    ----------
    points, triangles
        The filled solid, closed, ``(n, 3)`` mm and ``(m, 3)``; shells of negative volume are voids.
    region
        The region, closed.
    whole
        The solid before filling, closed.
    """
    shells = measure_shells(points, triangles)
    corners = points[triangles]
    outward = shells.volume > 0.0
    detached = outward & ~_reaching_out(corners, shells.label, len(shells.volume), region)
    detached[_largest_each(points, triangles, shells, detached, region, whole)] = False
    if not detached.any():
        return DetachedSplit((points, triangles), (np.empty((0, 3)), np.empty((0, 3), np.int64)), 0)
    gone = detached[shells.label]
    separate = drop_unused_vertices(points, triangles[gone])
    first = np.unique(shells.label, return_index=True)[1]
    voids = np.flatnonzero(~outward)
    detached[voids] = _within(points[triangles[first[voids], 0]], separate)
    count = int((detached & (shells.volume > CRUMB)).sum())
    gone = detached[shells.label]
    return DetachedSplit(
        drop_unused_vertices(points, triangles[~gone]), drop_unused_vertices(points, triangles[gone]), count
    )


def count_components(points: Floats, triangles: Int64s) -> int:
    """Return the number of disconnected components of a closed solid, without fragments and voids."""
    return int((measure_shells(points, triangles).volume > CRUMB).sum()) if len(triangles) else 0


def genus_of(points: Floats, triangles: Int64s) -> int:
    """Return the genus of a closed mesh, summed over its shells; no vertex may belong to two shells."""
    shells = len(measure_shells(points, triangles).volume)
    used = len(np.unique(triangles))
    euler = used - len(triangles) // 2  # a closed mesh has 3 / 2 as many edges as triangles
    return shells - euler // 2


def _reaching_out(corners: Floats, label: Int64s, count: int, region: MeshArrays) -> Bools:
    """Tell which shells have material outside the region below their surface, ``(count,)``."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    valid = np.flatnonzero(length > 1e-9)
    below = corners[valid].mean(axis=1) - _INWARD * normal[valid] / length[valid, None]
    out = valid[~_within(below, region)]
    return np.asarray(np.bincount(label[out], minlength=count) > 0)


def _largest_each(
    points: Floats, triangles: Int64s, shells: Shells, detached: Bools, region: MeshArrays, whole: MeshArrays
) -> Int64s:
    """Return the largest detached shell in each component of the whole that is completely inside the region."""
    if not detached.any():
        return np.empty(0, np.int64)
    before = measure_shells(*whole)
    corners = whole[0][whole[1]]
    covered = (before.volume > CRUMB) & ~_reaching_out(corners, before.label, len(before.volume), region)
    number = np.flatnonzero(detached)
    first = np.unique(shells.label, return_index=True)[1][number]
    middle = _below(points[triangles[first]])
    found = []
    for piece in np.flatnonzero(covered):
        within = _within(middle, drop_unused_vertices(whole[0], whole[1][before.label == piece]))
        if within.any():
            found.append(number[within][shells.volume[number[within]].argmax()])
    return np.array(found, np.int64)


def _below(corners: Floats) -> Floats:
    """Return a point slightly below the centre of each triangle."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    return np.asarray(corners.mean(axis=1) - _INWARD * normal)


def _within(points: Floats, solid: MeshArrays) -> Bools:
    return inside(points, solid[0], solid[1].astype(np.int32))
