"""Apply support blockers and enforcers to a part: subdivide its mesh at their borders and select the triangles."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.subdivision import subdivide
from amprep.geometry.overhangs.candidates import Modifiers
from amprep.model.mesh import Mesh
from amprep.model.part import Region, RegionKind

FINEST, COARSEST = 0.4, 4.0
"""Size (mm) to which triangles are split at the border of a region, and wherever a region may be inside a triangle."""

_SAMPLES, _INWARDS = 7, 0.98
"""Number of sample points of a triangle; position of the outer ones as a fraction of the way from its centre."""


class ModifiedMesh(NamedTuple):
    """A mesh in build coordinates, and the triangles that blockers and enforcers select; None without any."""

    mesh: Mesh
    modifiers: Modifiers | None


class _MarkingVolume(NamedTuple):
    """A region given by a closed mesh in build coordinates; samples of triangles over `coarse` mm may miss it."""

    mesh: Mesh
    coarse: float

    def holds(self, points: Floats) -> Bools:
        """Tell which points ``(n, 3)`` are inside."""
        return inside(points, self.mesh.vertices, self.mesh.triangles)


class _MarkingPaint(NamedTuple):
    """Painted pieces ``(k, 3, 3)`` in build coordinates, and their triangles ``(k,)`` of the part, in sorted order."""

    pieces: Floats
    owner: Int64s

    def holds(self, points: Floats, parent: Int64s) -> Bools:
        """Tell which points ``(n, 3)`` are painted; `parent` ``(n,)`` is the triangle of each."""
        point, piece = _pairs(parent, self.owner)
        found = np.zeros(len(points), np.bool_)
        np.logical_or.at(found, point, _in_triangles(points[point], self.pieces[piece]))
        return found


class _Regions(NamedTuple):
    """Regions of one kind, by the way they are given: closed meshes, painted pieces, and whole triangles."""

    volumes: tuple[_MarkingVolume, ...]
    paints: tuple[_MarkingPaint, ...]
    wholes: tuple[Ints, ...]

    def select(self, mesh: Mesh, parent: Int64s) -> Bools:
        """Tell which triangles are selected, by their centres or by their parents ``(m,)`` in the part's own mesh."""
        centres = mesh.vertices[mesh.triangles].mean(axis=1)
        found = self.hold(centres)
        for paint in self.paints:
            found |= paint.holds(centres, parent)
        for whole in self.wholes:
            found |= np.isin(parent, whole)
        return found

    def hold(self, points: Floats) -> Bools:
        """Tell which points are inside a volume."""
        found = np.zeros(len(points), np.bool_)
        for volume in self.volumes:
            found |= volume.holds(points)
        return found


def apply_regions(mesh: Mesh, regions: Sequence[Region], matrix: Floats) -> ModifiedMesh:
    """Subdivide a mesh at the borders of blockers and enforcers, and select the triangles that they contain.

    A region selects the triangles that it names, the pieces painted on triangles, or everything inside its mesh.
    Only downward triangles are subdivided, to `FINEST` mm.

    Parameters
    ----------
    mesh
        The part in build coordinates.
    regions
        Regions of the part, in part coordinates; other kinds than blockers and enforcers are ignored.
    matrix
        ``(4, 4)`` part coordinates to build coordinates.
    """
    blockers = _regions_of(regions, "blocker", matrix)
    enforcers = _regions_of(regions, "enforcer", matrix)
    if not any((*blockers, *enforcers)):
        return ModifiedMesh(mesh, None)

    def is_to_split(corners: Floats, parent: Int64s) -> Bools:
        size = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
        large = np.flatnonzero((size > FINEST) & (_normal_z(corners) < 0.0))
        split = np.zeros(len(corners), np.bool_)
        for volume in (*blockers.volumes, *enforcers.volumes):
            split[large] |= _cut_by(volume, corners[large], size[large])
        for paint in (*blockers.paints, *enforcers.paints):
            split[large] |= _painted_in_part(paint, corners[large], parent[large])
        return split

    fine = subdivide(mesh.vertices, mesh.triangles, is_to_split)
    finer = mesh if len(fine.triangles) == len(mesh.triangles) else Mesh(fine.vertices, fine.triangles)
    blocked = blockers.select(finer, fine.parent)
    vertices = np.isin(np.arange(len(finer.vertices)), finer.triangles[blocked])
    vertices |= blockers.hold(finer.vertices)
    return ModifiedMesh(finer, Modifiers(enforcers.select(finer, fine.parent), blocked, vertices))


def _regions_of(regions: Sequence[Region], kind: RegionKind, matrix: Floats) -> _Regions:
    """Return the regions of one kind in build coordinates."""
    own = [region for region in regions if region.kind == kind]
    meshes = [(region.mesh.moved(matrix), region.triangles) for region in own if region.mesh is not None]
    return _Regions(
        tuple(_volume(mesh) for mesh, triangles in meshes if triangles is None and len(mesh.triangles)),
        tuple(_paint(mesh, triangles) for mesh, triangles in meshes if triangles is not None),
        tuple(each.triangles for each in own if each.mesh is None and each.triangles is not None),
    )


def _volume(mesh: Mesh) -> _MarkingVolume:
    extent = float(np.ptp(mesh.vertices[:, :2], axis=0).min())
    return _MarkingVolume(mesh, min(max(extent / 3, FINEST), COARSEST))


def _paint(mesh: Mesh, owner: Ints) -> _MarkingPaint:
    order = np.argsort(owner, kind="stable")
    return _MarkingPaint(mesh.vertices[mesh.triangles][order], owner[order].astype(np.int64))


def _cut_by(volume: _MarkingVolume, corners: Floats, size: Floats) -> Bools:
    """Tell which triangles are partly inside a volume, or are so large that they may contain all of it."""
    lo, hi = volume.mesh.bounds
    split = (corners.min(axis=1) <= hi).all(axis=1) & (corners.max(axis=1) >= lo).all(axis=1)
    small = np.flatnonzero(split & (size <= volume.coarse))
    held = volume.holds(_samples(corners[small]).reshape(-1, 3)).reshape(len(small), _SAMPLES)
    split[small] = held.any(axis=1) & ~held.all(axis=1)
    return np.asarray(split)


def _painted_in_part(paint: _MarkingPaint, corners: Floats, parent: Int64s) -> Bools:
    """Tell which triangles are partly painted."""
    split = np.zeros(len(corners), np.bool_)
    near = np.flatnonzero(np.isin(parent, paint.owner))
    samples = _samples(corners[near])
    held = paint.holds(samples.reshape(-1, 3), np.repeat(parent[near], _SAMPLES))
    held = held.reshape(len(near), _SAMPLES)
    triangle, piece = _pairs(parent[near], paint.owner)
    within = np.zeros(len(near), np.bool_)
    for each in np.moveaxis(_samples(paint.pieces), 1, 0):
        np.logical_or.at(within, triangle, _in_triangles(each[piece], corners[near][triangle]))
    split[near] = (held.any(axis=1) | within) & ~held.all(axis=1)
    return split


def _normal_z(corners: Floats) -> Floats:
    """Return the z component of the normals, up to a positive factor."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _samples(corners: Floats) -> Floats:
    """Return points ``(m, 7, 3)`` of each triangle: centre, and points just inside corners and edge midpoints."""
    centre = corners.mean(axis=1, keepdims=True)
    rim = np.concatenate([corners, (corners + np.roll(corners, -1, axis=1)) / 2], axis=1)
    return np.concatenate([centre, centre + _INWARDS * (rim - centre)], axis=1)


def _pairs(parent: Int64s, owner: Int64s) -> tuple[Int64s, Int64s]:
    """Return all pairs of an index into `parent` and an index into the sorted `owner` that have the same value."""
    first, last = np.searchsorted(owner, parent, side="left"), np.searchsorted(owner, parent, side="right")
    count = last - first
    one = np.repeat(np.arange(len(parent)), count)
    other = np.arange(len(one)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
    return one, other


def _in_triangles(points: Floats, corners: Floats) -> Bools:
    """Tell for each point ``(n, 3)`` whether it is in its triangle ``(n, 3, 3)``; both are in the same plane."""
    a, b, c = (corners[:, i] for i in range(3))
    normal = np.cross(b - a, c - a)
    held = np.ones(len(points), np.bool_)
    for start, end in ((a, b), (b, c), (c, a)):
        held &= np.einsum("ij,ij->i", np.cross(end - start, points - start), normal) >= 0.0
    return held
