"""Which triangles of a part its blockers and enforcers mark, cut along the edges of what marks them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.subdivision import subdivide
from amprep.geometry.overhangs.find import Modifiers
from amprep.model.mesh import Mesh
from amprep.model.part import Region, RegionKind

FINEST, COARSEST = 0.4, 4.0
"""mm; triangles are split down to the first along the edges of a region, and to the second wherever it may lie."""

_SAMPLES, _INWARDS = 7, 0.98
"""How many points of a triangle are looked at, and the share of the way from its centre to the outer ones."""


class ModifiedMesh(NamedTuple):
    """A mesh in build coordinates and what is marked of it; None when nothing is."""

    mesh: Mesh
    modifiers: Modifiers | None


class _MarkingVolume(NamedTuple):
    """A region with a closed mesh of its own, in build coordinates; it may lie amid triangles over `coarse` mm."""

    mesh: Mesh
    coarse: float

    def holds(self, points: Floats) -> Bools:
        return inside(points, self.mesh.vertices, self.mesh.triangles)


class _MarkingPaint(NamedTuple):
    """Pieces ``(k, 3, 3)`` painted on triangles ``(k,)`` of the part, in build coordinates; sorted by triangle."""

    pieces: Floats
    owner: Int64s

    def holds(self, points: Floats, parent: Int64s) -> Bools:
        """Tell which of the points ``(n, 3)`` on triangles `parent` are painted."""
        point, piece = _pairs(parent, self.owner)
        found = np.zeros(len(points), np.bool_)
        np.logical_or.at(found, point, _in_triangles(points[point], self.pieces[piece]))
        return found


class _Regions(NamedTuple):
    """Regions of one kind by what marks: volumes, paint, and triangles marked as wholes."""

    volumes: tuple[_MarkingVolume, ...]
    paints: tuple[_MarkingPaint, ...]
    wholes: tuple[Ints, ...]

    def mark(self, mesh: Mesh, parent: Int64s) -> Bools:
        """Tell which triangles are marked: by their centres, or by the triangles they are pieces of."""
        centres = mesh.vertices[mesh.triangles].mean(axis=1)
        found = self.hold(centres)
        for paint in self.paints:
            found |= paint.holds(centres, parent)
        for whole in self.wholes:
            found |= np.isin(parent, whole)
        return found

    def hold(self, points: Floats) -> Bools:
        """Tell which points lie in a volume."""
        found = np.zeros(len(points), np.bool_)
        for volume in self.volumes:
            found |= volume.holds(points)
        return found


def apply_regions(mesh: Mesh, regions: Sequence[Region], matrix: Floats) -> ModifiedMesh:
    """Return `mesh`, the part under `matrix`, split where blockers and enforcers cut triangles, and the marks.

    A region marks the triangles it names, the pieces painted on them, or whatever lies in its mesh. Only
    triangles that look down are split, to `FINEST` mm.
    """
    blockers = _sorted(regions, "blocker", matrix)
    enforcers = _sorted(regions, "enforcer", matrix)
    if not any((*blockers, *enforcers)):
        return ModifiedMesh(mesh, None)

    def wish(corners: Floats, parent: Int64s) -> Bools:
        size = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
        large = np.flatnonzero((size > FINEST) & (_looks(corners) < 0.0))
        wanted = np.zeros(len(corners), np.bool_)
        for volume in (*blockers.volumes, *enforcers.volumes):
            wanted[large] |= _cut_by(volume, corners[large], size[large])
        for paint in (*blockers.paints, *enforcers.paints):
            wanted[large] |= _painted_in_part(paint, corners[large], parent[large])
        return wanted

    fine = subdivide(mesh.vertices, mesh.triangles, wish)
    finer = mesh if len(fine.triangles) == len(mesh.triangles) else Mesh(fine.vertices, fine.triangles)
    blocked = blockers.mark(finer, fine.parent)
    vertices = np.isin(np.arange(len(finer.vertices)), finer.triangles[blocked])
    vertices |= blockers.hold(finer.vertices)
    return ModifiedMesh(finer, Modifiers(enforcers.mark(finer, fine.parent), blocked, vertices))


def _sorted(regions: Sequence[Region], kind: RegionKind, matrix: Floats) -> _Regions:
    """Bring the regions of one kind into build coordinates."""
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
    """Tell which triangles lie partly in a volume, or are so large that it might lie amid them."""
    lo, hi = volume.mesh.bounds
    wanted = (corners.min(axis=1) <= hi).all(axis=1) & (corners.max(axis=1) >= lo).all(axis=1)
    small = np.flatnonzero(wanted & (size <= volume.coarse))
    held = volume.holds(_samples(corners[small]).reshape(-1, 3)).reshape(len(small), _SAMPLES)
    wanted[small] = held.any(axis=1) & ~held.all(axis=1)
    return np.asarray(wanted)


def _painted_in_part(paint: _MarkingPaint, corners: Floats, parent: Int64s) -> Bools:
    """Tell which triangles are painted here and bare there."""
    wanted = np.zeros(len(corners), np.bool_)
    near = np.flatnonzero(np.isin(parent, paint.owner))
    samples = _samples(corners[near])
    held = paint.holds(samples.reshape(-1, 3), np.repeat(parent[near], _SAMPLES))
    held = held.reshape(len(near), _SAMPLES)
    triangle, piece = _pairs(parent[near], paint.owner)
    within = np.zeros(len(near), np.bool_)
    for each in np.moveaxis(_samples(paint.pieces), 1, 0):
        np.logical_or.at(within, triangle, _in_triangles(each[piece], corners[near][triangle]))
    wanted[near] = (held.any(axis=1) | within) & ~held.all(axis=1)
    return wanted


def _looks(corners: Floats) -> Floats:
    """Return the vertical part of the normals, up to a factor."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _samples(corners: Floats) -> Floats:
    """Return points ``(m, 7, 3)`` of each triangle: centre, and just inside corners and middles of edges."""
    centre = corners.mean(axis=1, keepdims=True)
    rim = np.concatenate([corners, (corners + np.roll(corners, -1, axis=1)) / 2], axis=1)
    return np.concatenate([centre, centre + _INWARDS * (rim - centre)], axis=1)


def _pairs(parent: Int64s, owner: Int64s) -> tuple[Int64s, Int64s]:
    """Return the pairs (index into `parent`, index into the sorted `owner`) of equal value."""
    first, last = np.searchsorted(owner, parent, side="left"), np.searchsorted(owner, parent, side="right")
    count = last - first
    one = np.repeat(np.arange(len(parent)), count)
    other = np.arange(len(one)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
    return one, other


def _in_triangles(points: Floats, corners: Floats) -> Bools:
    """Tell for each point ``(n, 3)`` whether it lies in its triangle ``(n, 3, 3)``, both in one plane."""
    a, b, c = (corners[:, i] for i in range(3))
    normal = np.cross(b - a, c - a)
    held = np.ones(len(points), np.bool_)
    for start, end in ((a, b), (b, c), (c, a)):
        held &= np.einsum("ij,ij->i", np.cross(end - start, points - start), normal) >= 0.0
    return held
