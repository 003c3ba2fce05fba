"""Find and sample overhangs for the judge of coverage; no code is shared with the planner's search.

Strategy. The planner decides from sections and from the order of faces around an edge whether the solid is above an
edge or a tip. The judge uses pseudonormals instead (Baerentzen and Aanaes, 2005, DOI 10.1109/TVCG.2005.49): where
all faces rise, the point just below is outside exactly if the sum of the face normals, at a vertex weighted by the
angles, points down. Blockers and enforcers do not cut triangles here; they select sample points. Their borders are
uncertain by `_BORDER`, within which the judge gives the planner the benefit of the doubt.
"""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.sampling import OverhangSamples, sample_overhangs, sample_triangles
from amprep.geometry.overhangs.regions import Overhangs
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.model.part import Region, RegionKind
from amprep.model.supports import SupportRules

KINDS = ("face", "edge", "tip")
"""Kinds of overhangs; the regions of the samples are indices into it."""

_GRANT_DEG = 0.02
"""Faces and edges this close to the overhang angle need no support, whatever rounding in a file makes of them."""

_LEVEL, _ON_PLATE = 1e-6, 1e-3
"""Heights (mm) that differ by less are equal; geometry nearer to the plate than this stands on it."""

_BORDER = 0.8
"""Uncertainty (mm) of the borders of blockers and enforcers."""


class _MergedMesh(NamedTuple):
    """A mesh with coincident vertices merged; arrays over its triangles, edges and half-edges.

    Attributes
    ----------
    points, triangles
        ``(n, 3)`` mm, ``(m, 3)``.
    first
        ``(n,)`` index of each point in the mesh given.
    normal, area
        ``(m, 3)`` unit normals (zero for degenerate triangles), ``(m,)`` mm2.
    ends
        ``(e, 2)`` points of each edge.
    edge
        ``(m, 3)`` edge from each corner of a triangle to the next.
    """

    points: Floats
    triangles: Int64s
    first: Int64s
    normal: Floats
    area: Floats
    ends: Int64s
    edge: Int64s

    @property
    def is_down(self) -> Bools:
        """``(m,)`` bool, triangles above the plate that face downwards."""
        above = self.points[self.triangles, 2].max(axis=1, initial=-np.inf) > _ON_PLATE
        return np.asarray(above & (self.normal[:, 2] < -_LEVEL))


def overhang_samples(placed: PlacedPart, rules: SupportRules, spacing: float) -> OverhangSamples:
    """Return points on the overhangs of a placed part; the region of each is an index into `KINDS`.

    Parameters
    ----------
    placed
        The part in the build; its own angle, blockers and enforcers count.
    rules
        Overhang angle, smallest area and smallest length.
    spacing
        Distance of the points, mm.
    """
    regions, own = placed.part.regions, placed.part.overrides
    mesh = placed.mesh
    if own.supports is False or not len(mesh.triangles):
        return OverhangSamples(np.empty((0, 3)), np.empty(0, np.int64), np.empty(0, np.bool_))
    angle = rules.overhang_angle_deg if own.overhang_angle_deg is None else own.overhang_angle_deg
    surface = _surface_of(mesh)
    enforced = (
        np.isin(np.arange(len(mesh.triangles)), _whole_triangles(regions, "enforcer")) & surface.is_down
    )
    blocked = np.isin(np.arange(len(mesh.triangles)), _whole_triangles(regions, "blocker"))
    found = _find(surface, rules, np.radians(max(angle - _GRANT_DEG, 0.0)), enforced, blocked)
    samples = sample_overhangs(mesh.vertices, mesh.triangles, found, spacing)
    samples = _joined(samples, _enforced_samples(placed, surface, spacing))
    free = ~_in_blockers(samples.points, placed)
    if free.all():
        return samples
    return _without_small_patches(_chosen(samples, free), spacing, rules.min_area_mm2)


def border_of(placed: PlacedPart) -> float:
    """Return the distance (mm) beyond `reach` at which the planner may still place contacts of a part."""
    return _BORDER if any(region.kind in ("blocker", "enforcer") for region in placed.part.regions) else 0.0


def _surface_of(mesh: Mesh) -> _MergedMesh:
    _, first, merged = np.unique(np.round(mesh.vertices, 6), axis=0, return_index=True, return_inverse=True)
    points, triangles = mesh.vertices[first], merged.reshape(-1)[mesh.triangles].astype(np.int64)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    size = np.linalg.norm(cross, axis=1)
    normal = cross / np.where(size > 0, size, 1.0)[:, None]
    pairs = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    ends, edge = np.unique(pairs, axis=0, return_inverse=True)
    return _MergedMesh(points, triangles, first, normal, size / 2, ends, edge.reshape(-1, 3))


def _find(
    surface: _MergedMesh, rules: SupportRules, angle: float, enforced: Bools, blocked: Bools
) -> Overhangs:
    """Return overhanging faces, knife edges and tips, without those that are too small (angles in radians)."""
    above = surface.points[surface.triangles, 2].max(axis=1) > _ON_PLATE
    steep = (above & (-surface.normal[:, 2] > np.cos(angle))) | enforced
    starts = _starts(surface)
    sharp = _knife_edges(surface, steep, angle)
    touched = np.zeros(len(surface.points), np.bool_)
    touched[surface.triangles[steep]] = True
    touched[surface.ends[sharp]] = True
    plateau = _plateaus(surface)
    tips = np.flatnonzero(starts & ~np.isin(plateau, plateau[touched]))

    at_blocked = np.zeros(len(surface.points), np.bool_)
    at_blocked[surface.triangles[blocked]] = True
    faces = np.flatnonzero(steep & ~blocked)
    label = _labels(surface.edge[faces].reshape(-1), np.repeat(np.arange(len(faces)), 3), len(faces))
    kept = _large(label, surface.area[faces], rules.min_area_mm2)
    kept |= np.isin(label, label[starts[surface.triangles[faces]].any(axis=1) | enforced[faces]])
    sharp = sharp[~at_blocked[surface.ends[sharp]].all(axis=1)]
    ends = surface.ends[sharp]
    label = _labels(ends.reshape(-1), np.repeat(np.arange(len(ends)), 2), len(ends))
    length = np.linalg.norm(surface.points[ends[:, 1]] - surface.points[ends[:, 0]], axis=1)
    long = _large(label, length, rules.min_length_mm) | np.isin(label, label[starts[ends].any(axis=1)])
    faces, ends, tips = faces[kept], surface.first[ends[long]], surface.first[tips[~at_blocked[tips]]]
    kinds = (np.full(len(each), kind, np.int32) for kind, each in enumerate((faces, ends, tips)))
    face_kind, edge_kind, tip_kind = kinds
    return Overhangs(
        faces.astype(np.int32),
        face_kind,
        ends.astype(np.int32),
        edge_kind,
        tips.astype(np.int32),
        tip_kind,
        (),
    )


def _knife_edges(surface: _MergedMesh, steep: Bools, angle: float) -> Int64s:
    """Return the edges flatter than the angle from which all faces rise, with the solid above them."""
    start, end = (surface.points[surface.ends[:, i]] for i in (0, 1))
    along = end - start
    length = np.linalg.norm(along, axis=1)
    flat = (np.abs(along[:, 2]) < length * np.sin(angle)) & (np.maximum(start[:, 2], end[:, 2]) > _ON_PLATE)
    edge, face = surface.edge.reshape(-1), np.repeat(np.arange(len(surface.triangles)), 3)
    sound = (surface.triangles != np.roll(surface.triangles, 1, axis=1)).all(axis=1)[face]
    opposite = np.roll(surface.triangles, -2, axis=1).reshape(-1)
    unit = along / np.where(length > 0, length, 1.0)[:, None]
    ray = surface.points[opposite] - start[edge]
    ray -= np.einsum("ij,ij->i", ray, unit[edge])[:, None] * unit[edge]
    height = np.linalg.norm(
        ray, axis=1
    )  # of the triangle above the edge; of degenerate ones it is mere rounding
    falls = (ray[:, 2] <= _LEVEL * height) | (height <= _LEVEL) | steep[face]
    rising = np.bincount(edge, weights=falls & sound, minlength=len(along)) == 0
    faces = np.bincount(edge, weights=sound, minlength=len(along))
    down = np.bincount(edge, weights=surface.normal[face, 2], minlength=len(along)) < 0
    return np.flatnonzero(flat & rising & (down | (faces == 1)) & (faces > 0))


def _plateaus(surface: _MergedMesh) -> Int64s:
    """Label the points; points that level edges connect have the same label."""
    z = surface.points[:, 2]
    level = surface.ends[np.abs(np.diff(z[surface.ends], axis=1)[:, 0]) <= _LEVEL]
    return _components(level[:, 0], level[:, 1], len(z))


def _starts(surface: _MergedMesh) -> Bools:
    """Tell at which points the part would start in the air: local minima with the solid above them."""
    z, plateau = surface.points[:, 2], _plateaus(surface)
    rise = np.diff(z[surface.ends], axis=1)[:, 0]
    low = np.where(rise > 0, surface.ends[:, 1], surface.ends[:, 0])[np.abs(rise) > _LEVEL]
    minimum = np.ones(int(plateau.max(initial=-1)) + 1, np.bool_)
    minimum[plateau[low]] = False
    minimum[plateau[z <= _ON_PLATE]] = False
    weight = np.zeros(len(minimum))
    corners = surface.points[surface.triangles]
    for i in range(3):
        a, b = (corners[:, (i + step) % 3] - corners[:, i] for step in (1, 2))
        between = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))
        np.add.at(weight, plateau[surface.triangles[:, i]], between * surface.normal[:, 2])
    return np.asarray((minimum & (weight < 0))[plateau])


def _labels(node: Int64s, member: Int64s, count: int) -> Int64s:
    """Label `count` members; members that share a node have the same label."""
    _, number = np.unique(node, return_inverse=True)
    nodes = int(number.max(initial=-1)) + 1
    return _components(number.reshape(-1), member + nodes, nodes + count)[nodes:]


def _components(one: Int64s, other: Int64s, count: int) -> Int64s:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def _large(label: Int64s, measure: Floats, smallest: float) -> Bools:
    """Tell which members belong to components of at least the smallest measure, up to rounding."""
    return np.asarray(np.bincount(label, weights=measure)[label] >= smallest * (1.0 + 1e-6))


def _whole_triangles(regions: tuple[Region, ...], kind: RegionKind) -> Int64s:
    """Return the triangles that regions of one kind name."""
    named = [each.triangles for each in regions if each.kind == kind and each.mesh is None]
    return np.concatenate([np.empty(0, np.int64), *(each for each in named if each is not None)])


def _volumes(placed: PlacedPart, kind: RegionKind) -> list[Mesh]:
    """Return the closed meshes of the regions of one kind, in build coordinates."""
    own = [each for each in placed.part.regions if each.kind == kind and each.triangles is None]
    return [each.mesh.moved(placed.matrix) for each in own if each.mesh is not None]


def _painted(placed: PlacedPart, kind: RegionKind, chosen: Bools | None = None) -> Floats:
    """Return the painted triangles ``(k, 3, 3)`` of one kind in build coordinates, of the chosen triangles only."""
    found = [np.empty((0, 3, 3))]
    for each in placed.part.regions:
        if each.kind == kind and each.mesh is not None and each.triangles is not None:
            mesh = each.mesh.moved(placed.matrix)
            corners = mesh.vertices[mesh.triangles]
            found.append(corners if chosen is None else corners[chosen[each.triangles]])
    return np.concatenate(found)


def _enforced_samples(placed: PlacedPart, surface: _MergedMesh, spacing: float) -> OverhangSamples:
    """Return points on downward faces that are in the middle of enforcers."""
    down = surface.is_down
    corners = placed.mesh.vertices[placed.mesh.triangles[down]]
    volumes = _volumes(placed, "enforcer")
    points = sample_triangles(corners, spacing) if volumes else np.empty((0, 3))
    within = np.zeros(len(points), np.bool_)
    for volume in volumes:
        within |= np.all(
            [inside(each, volume.vertices, volume.triangles) for each in _around(points)], axis=0
        )
    points = np.concatenate([points[within], sample_triangles(_painted(placed, "enforcer", down), spacing)])
    return OverhangSamples(points, np.zeros(len(points), np.int64), np.zeros(len(points), np.bool_))


def _in_blockers(points: Floats, placed: PlacedPart) -> Bools:
    """Tell which points are in a blocker or within `_BORDER` of one."""
    from scipy.spatial import KDTree

    within = np.zeros(len(points), np.bool_)
    for volume in _volumes(placed, "blocker"):
        within |= np.any(
            [inside(each, volume.vertices, volume.triangles) for each in _around(points)], axis=0
        )
    painted = _painted(placed, "blocker")
    if len(painted) and len(points):
        distance, _ = KDTree(sample_triangles(painted, _BORDER / 2)).query(points)
        within |= distance <= 1.5 * _BORDER
    return within


def _around(points: Floats) -> list[Floats]:
    """Return the points, and the points moved by `_BORDER` along each axis both ways."""
    return [points, *(points + sign * step for step in np.eye(3) * _BORDER for sign in (-1.0, 1.0))]


def _without_small_patches(samples: OverhangSamples, spacing: float, min_area: float) -> OverhangSamples:
    """Remove the patches of samples, left over by blockers, that may be smaller than the smallest area."""
    from scipy.spatial import KDTree

    pairs = KDTree(samples.points).query_pairs(2.0 * spacing, output_type="ndarray")
    label = _components(pairs[:, 0], pairs[:, 1], len(samples.points))
    large = np.bincount(label)[label] * spacing**2 >= 4.0 * min_area
    return _chosen(samples, large)


def _joined(one: OverhangSamples, other: OverhangSamples) -> OverhangSamples:
    return OverhangSamples(*(np.concatenate(each) for each in zip(one, other, strict=True)))


def _chosen(samples: OverhangSamples, chosen: Bools) -> OverhangSamples:
    return OverhangSamples(samples.points[chosen], samples.region[chosen], samples.inner[chosen])
