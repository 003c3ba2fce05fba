"""What of a mesh needs support: faces, knife edges and downward tips (thesis 3.1)."""

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Longs = NDArray[np.int64]
Bools = NDArray[np.bool_]

Kind = Literal["face", "edge", "tip"]

ANGLE_TOLERANCE_DEG = 0.01
"""Geometry this close to the threshold angle counts as steep enough."""

_ON_PLATE = 1e-3
_LEVEL = 1e-6
"""mm; vertices closer than this in height are level, closer than this in space are one."""


class OverhangRegion(NamedTuple):
    """A connected region that needs support.

    Attributes
    ----------
    kind
        ``face``, ``edge`` or ``tip``.
    measure
        Area in mm2, length in mm, or 0 for a tip.
    centre
        ``(3,)`` mm, weighted by area or length.
    """

    kind: Kind
    measure: float
    centre: Floats


class Overhangs(NamedTuple):
    """Everything of a mesh that needs support, in connected regions.

    Attributes
    ----------
    faces
        ``(f,)`` int32, triangles.
    face_region
        ``(f,)`` int32, index into `regions`; labels of faces come first, then edges, then tips.
    edges
        ``(e, 2)`` int32, vertex indices.
    edge_region
        ``(e,)`` int32.
    tips
        ``(t,)`` int32, vertex indices.
    tip_region
        ``(t,)`` int32.
    """

    faces: Ints
    face_region: Ints
    edges: Ints
    edge_region: Ints
    tips: Ints
    tip_region: Ints
    regions: tuple[OverhangRegion, ...]


class _Surface(NamedTuple):
    """A mesh with coincident vertices merged and its half-edges sorted by edge.

    `half_edge` gives each half-edge's edge, `opposite` the corner across from it, `half_face` its triangle.
    """

    points: Floats
    first: Longs
    triangles: Longs
    edges: Longs
    half_edge: Longs
    half_face: Longs
    opposite: Longs


class Marks(NamedTuple):
    """What a person marked: triangles that must, triangles and vertices that must not be supported.

    A blocked edge has both its ends blocked. Marked triangles count only where they look down.
    """

    enforced: Bools
    blocked: Bools
    blocked_vertices: Bools


def find_overhangs(
    vertices: Floats,
    triangles: Ints,
    *,
    angle_deg: float,
    least_area: float = 0.0,
    least_length: float = 0.0,
    marks: Marks | None = None,
) -> Overhangs:
    """Find what needs support when the mesh is built upwards from the plate z = 0 (thesis 3.1).

    A face needs support when it looks down and its angle to the plate is under `angle_deg`. A knife edge
    does when its own angle is under `angle_deg`, the solid lies above it, all its faces rise from it, and
    none of them needs support itself. A tip is a local minimum of the solid that touches neither. Angles
    within 0.01 degrees of the threshold count as steep enough. What lies on the plate (z <= 0.001 mm) is
    held by it.

    Regions smaller than `least_area` (mm2) or `least_length` (mm) are dropped, unless they hold a local
    minimum (there the part would start in the air, however small the start) or an enforced triangle. Tips
    are local minima and never dropped.

    Parameters
    ----------
    vertices
        ``(n, 3)`` mm, in the build's position. Coincident ones are merged here; the indices returned
        refer to the arrays given.
    triangles
        ``(m, 3)``, normals out of the solid. Edges of one or of more than two faces are allowed.
    """
    surface = _merged(np.asarray(vertices, np.float64), np.asarray(triangles))
    normals = _unit_normals(surface)
    minimum = _minimum_plateaus(surface)
    needy = _needy_faces(surface, normals, angle_deg)
    sharp = surface.edges[_knife_edges(surface, normals, needy, angle_deg)]
    tips, tip_label = _tips(minimum, surface.triangles[needy], sharp)

    enforced = np.zeros(len(triangles), np.bool_)
    if marks is not None:
        enforced = marks.enforced & (normals[:, 2] < -_LEVEL) & _above_plate(surface)
        needy = (needy | enforced) & ~marks.blocked
        blocked = marks.blocked_vertices[surface.first]
        sharp = sharp[~blocked[sharp].all(axis=1)]
        tips, tip_label = tips[~blocked[tips]], tip_label[~blocked[tips]]
    faces = np.flatnonzero(needy)
    area = 0.5 * np.linalg.norm(_cross_products(surface.points, surface.triangles[faces]), axis=1)
    face_label = _components_of_faces(surface, needy)
    starts = np.asarray((minimum[surface.triangles[faces]] >= 0).any(axis=1) | enforced[faces])
    face_keep = _kept(face_label, area, least_area, starts)
    length = np.linalg.norm(surface.points[sharp[:, 1]] - surface.points[sharp[:, 0]], axis=1)
    edge_label = _components_of_edges(sharp, len(surface.points))
    edge_keep = _kept(edge_label, length, least_length, np.asarray((minimum[sharp] >= 0).any(axis=1)))
    return _labelled(
        surface,
        (faces[face_keep], face_label[face_keep], area[face_keep]),
        (sharp[edge_keep], edge_label[edge_keep], length[edge_keep]),
        (tips, tip_label),
    )


def _merged(vertices: Floats, triangles: NDArray[Any]) -> _Surface:
    keys = np.round(vertices / _LEVEL).astype(np.int64)
    order = np.lexsort(keys.T[::-1])
    new = np.ones(len(order), np.bool_)
    new[1:] = (keys[order[1:]] != keys[order[:-1]]).any(axis=1)
    merged = np.empty(len(order), np.int64)
    merged[order] = np.cumsum(new) - 1
    first = order[new]  # lexsort is stable: the least index of each position
    corners = merged[triangles]
    sound = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    half_face = np.repeat(np.flatnonzero(sound), 3)
    start, end = corners[sound].ravel(), np.roll(corners[sound], -1, axis=1).ravel()
    opposite = np.roll(corners[sound], -2, axis=1).ravel()
    key = np.minimum(start, end) * np.int64(len(first)) + np.maximum(start, end)
    edge_key, half_edge = np.unique(key, return_inverse=True)
    edges = np.column_stack(np.divmod(edge_key, max(len(first), 1)))
    by_edge = np.argsort(half_edge, kind="stable")
    return _Surface(
        vertices[first], first, corners, edges, half_edge[by_edge], half_face[by_edge], opposite[by_edge]
    )


def _cross_products(points: Floats, corners: Longs) -> Floats:
    a, b, c = points[corners[:, 0]], points[corners[:, 1]], points[corners[:, 2]]
    return np.asarray(np.cross(b - a, c - a), np.float64)


def _unit_normals(surface: _Surface) -> Floats:
    """Return unit normals; zero for triangles without area."""
    cross = _cross_products(surface.points, surface.triangles)
    size = np.linalg.norm(cross, axis=1, keepdims=True)
    return cross / np.where(size > 0, size, 1.0)


def _needy_faces(surface: _Surface, normals: Floats, angle_deg: float) -> Bools:
    steep_enough = np.cos(np.radians(max(angle_deg - ANGLE_TOLERANCE_DEG, 0.0)))
    return np.asarray(_above_plate(surface) & (-normals[:, 2] > steep_enough))


def _above_plate(surface: _Surface) -> Bools:
    """Tell which faces do not lie on the plate."""
    heights = surface.points[:, 2][surface.triangles]
    return np.asarray(heights.max(axis=1, initial=-np.inf) > _ON_PLATE)


def _knife_edges(surface: _Surface, normals: Floats, needy: Bools, angle_deg: float) -> Longs:
    """Find the shallow edges from which all faces rise, none of them needy, with the solid above them."""
    start, end = surface.points[surface.edges[:, 0]], surface.points[surface.edges[:, 1]]
    along = end - start
    length = np.linalg.norm(along, axis=1)
    shallow = np.abs(along[:, 2]) < length * np.sin(np.radians(max(angle_deg - ANGLE_TOLERANCE_DEG, 0.0)))
    shallow &= np.maximum(start[:, 2], end[:, 2]) > _ON_PLATE
    rising = np.ones(len(along), np.bool_)
    rise = surface.points[surface.opposite] - start[surface.half_edge]
    tangent = along / np.maximum(length, 1e-300)[:, None]
    halves = tangent[surface.half_edge]
    ray = rise - np.einsum("ij,ij->i", rise, halves)[:, None] * halves
    size = np.linalg.norm(ray, axis=1)
    sinks = (ray[:, 2] <= 1e-6 * size) | needy[surface.half_face]
    rising[surface.half_edge[sinks]] = False
    chosen = np.flatnonzero(shallow & rising)
    return chosen[_solid_above(surface, normals, ray, tangent, chosen)]


def _solid_above(surface: _Surface, normals: Floats, ray: Floats, tangent: Floats, edges: Longs) -> Bools:
    """Tell for each edge whether the solid lies above it.

    In the plane across the edge its faces are rays that rise from it; the solid lies above when the outside
    is clockwise of the rightmost ray. An edge of one face (an open wall) counts as above.
    """
    position = np.full(len(surface.edges), -1)
    position[edges] = np.arange(len(edges))
    halves = np.flatnonzero(position[surface.half_edge] >= 0)
    group = position[surface.half_edge[halves]]
    right = np.cross(tangent[surface.half_edge[halves]], (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    up = np.cross(right, tangent[surface.half_edge[halves]])
    across, above = np.einsum("ij,ij->i", ray[halves], right), np.einsum("ij,ij->i", ray[halves], up)
    order = np.lexsort((np.arctan2(above, across), group))
    rightmost = order[np.searchsorted(group[order], np.arange(len(edges)))]
    clockwise = above[rightmost, None] * right[rightmost] - across[rightmost, None] * up[rightmost]
    outside = np.einsum("ij,ij->i", normals[surface.half_face[halves[rightmost]]], clockwise) > 0
    alone = np.bincount(group, minlength=len(edges)) == 1
    return np.asarray(outside | alone)


def _minimum_plateaus(surface: _Surface) -> Longs:
    """Label each vertex by its level plateau where that is a local minimum above the plate, else -1."""
    count = len(surface.points)
    start, end = surface.edges[:, 0], surface.edges[:, 1]
    difference = surface.points[end, 2] - surface.points[start, 2]
    level = np.abs(difference) <= _LEVEL
    plateau = _components(start[level], end[level], count)
    lowest = np.zeros(int(plateau.max(initial=-1)) + 1, np.bool_)
    lowest[plateau[surface.edges.ravel()]] = True
    lowest[plateau[np.where(difference > 0, end, start)[~level]]] = False
    lowest[plateau[surface.points[:, 2] <= _ON_PLATE]] = False
    lowest &= _section_areas(surface, plateau, lowest) < 0
    return np.where(lowest[plateau], plateau, -1)


def _section_areas(surface: _Surface, plateau: Longs, lowest: Bools) -> Floats:
    """Measure the surface's level section just above each local minimum.

    The signed area is negative (clockwise seen from above) where the solid lies above the plateau, positive
    at the bottom of a pit. A triangle touches at most one minimum: of two the higher would not be one.
    """
    corners = surface.triangles
    inside = lowest[plateau[corners]]
    group = np.where(inside, plateau[corners], -1).max(axis=1, initial=-1)
    touching = np.flatnonzero((group >= 0) & ~inside.all(axis=1))
    corners, inside, group = corners[touching], inside[touching], group[touching]
    height = surface.points[corners, 2]
    floor = np.full(len(lowest), np.inf)
    np.minimum.at(floor, group, np.where(inside, height, np.inf).min(axis=1, initial=np.inf))
    ceiling = np.full(len(lowest), np.inf)
    np.minimum.at(ceiling, group, np.where(inside, np.inf, height).min(axis=1, initial=np.inf))
    level = 0.5 * (floor + ceiling)[group]
    origin = np.zeros((len(lowest), 2))
    origin[group] = surface.points[corners[np.arange(len(group)), inside.argmax(axis=1)], :2]
    down, up = np.zeros((len(group), 2)), np.zeros((len(group), 2))
    for i in range(3):
        j = (i + 1) % 3
        a, b = surface.points[corners[:, i]], surface.points[corners[:, j]]
        crosses = inside[:, i] != inside[:, j]
        share = np.divide(level - a[:, 2], b[:, 2] - a[:, 2], out=np.zeros(len(a)), where=crosses)
        point = a[:, :2] + np.clip(share, 0, 1)[:, None] * (b - a)[:, :2] - origin[group]
        leaves = crosses & inside[:, i]
        up[leaves], down[crosses & ~leaves] = point[leaves], point[crosses & ~leaves]
    signed = up[:, 0] * down[:, 1] - up[:, 1] * down[:, 0]
    return np.asarray(np.bincount(group, weights=signed, minlength=len(lowest)), np.float64)


def _components(start: Longs, end: Longs, count: int) -> Longs:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(start), np.int8), (start, end)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def _components_of_faces(surface: _Surface, needy: Bools) -> Longs:
    """Label the component of every needy face, over shared edges."""
    position = np.cumsum(needy) - 1
    halves = np.flatnonzero(needy[surface.half_face])
    same = surface.half_edge[halves[1:]] == surface.half_edge[halves[:-1]]
    faces = position[surface.half_face[halves]]
    return _components(faces[:-1][same], faces[1:][same], int(needy.sum()))


def _components_of_edges(edges: Longs, count: int) -> Longs:
    """Label the component of every edge, over shared vertices."""
    return _components(edges[:, 0], edges[:, 1], count)[edges[:, 0]]


def _kept(label: Longs, measure: Floats, least: float, always: Bools) -> Bools:
    """Tell which members belong to regions that are large enough or have a member to keep always."""
    keep = np.bincount(label, weights=measure) >= least
    keep[label[always]] = True
    return np.asarray(keep[label])


def _tips(minimum: Longs, corners: Longs, ends: Longs) -> tuple[Longs, Longs]:
    """Pick the vertices of the local minima that no needy face or edge touches, and the plateau of each."""
    held = np.zeros(int(minimum.max(initial=-1)) + 2, np.bool_)
    held[minimum[corners.ravel()]] = True
    held[minimum[ends.ravel()]] = True
    held[-1] = True  # the vertices that are no minimum
    tips = np.flatnonzero(~held[minimum])
    return tips, minimum[tips]


def _labelled(
    surface: _Surface,
    faces: tuple[Longs, Longs, Floats],
    edges: tuple[Longs, Longs, Floats],
    tips: tuple[Longs, Longs],
) -> Overhangs:
    """Label the regions 0, 1, ..., faces first, and measure them."""
    points = surface.points
    groups: list[Ints] = []
    regions: list[OverhangRegion] = []
    middle = points[surface.triangles[faces[0]]].mean(axis=1).reshape(-1, 3)
    halfway = points[edges[0]].mean(axis=1).reshape(-1, 3)
    kinds: tuple[tuple[Kind, Longs, Floats, Floats], ...] = (
        ("face", faces[1], faces[2], middle),
        ("edge", edges[1], edges[2], halfway),
        ("tip", tips[1], np.ones(len(tips[1])), points[tips[0]]),
    )
    for kind, label, weight, centres in kinds:
        number = _by_first_appearance(label)
        groups.append((number + len(regions)).astype(np.int32))
        total = np.bincount(number, weights=weight)
        centre = [np.bincount(number, weights=weight * centres[:, i]) / total for i in range(3)]
        for i in range(len(total)):
            measure = 0.0 if kind == "tip" else float(total[i])
            regions.append(OverhangRegion(kind, measure, np.array([c[i] for c in centre])))
    first = surface.first.astype(np.int32)
    return Overhangs(
        faces[0].astype(np.int32),
        groups[0],
        first[edges[0]],
        groups[1],
        first[tips[0]],
        groups[2],
        tuple(regions),
    )


def _by_first_appearance(label: Longs) -> Longs:
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[inverse]
