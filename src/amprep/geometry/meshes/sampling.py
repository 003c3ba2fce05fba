"""Sample points on faces, edges and tips, at most a given distance apart."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int32s, Int64s
from amprep.geometry.overhangs.regions import Overhangs


class OverhangSamples(NamedTuple):
    """Points ``(n, 3)`` mm on overhangs, and the region ``(n,)`` of each.

    `inner` marks the points of a lattice over the faces; each of them represents the same area in plan. `face` is the
    index of the face of each point among those of the overhangs, -1 on knife edges and tips.
    """

    points: Floats
    region: Int64s
    inner: Bools
    face: Int64s


def sample_overhangs(
    vertices: Floats, triangles: Int32s, overhangs: Overhangs, spacing: float
) -> OverhangSamples:
    """Return sample points on overhangs: a lattice on their faces, the rims of these, knife edges, and tips.

    Every point of a face has a sample within ``spacing / sqrt(2)`` in plan, every point of a rim or a knife edge one
    within ``spacing / 2``.

    Parameters
    ----------
    vertices, triangles
        The mesh, ``(n, 3)`` mm and ``(m, 3)``.
    overhangs
        Overhangs with indices into the mesh.
    spacing
        Pitch of the lattice, mm.
    """
    faces = np.asarray(triangles[overhangs.faces], np.int64)
    inner, owner = _lattice(vertices, faces, spacing)
    ends, rim_owner = _rim(faces)
    rims, rim = sample_segments(vertices[ends[:, 0]], vertices[ends[:, 1]], spacing)
    sharp = overhangs.edges
    edges, edge = sample_segments(vertices[sharp[:, 0]], vertices[sharp[:, 1]], spacing)
    region = [
        overhangs.face_region[owner],
        overhangs.face_region[rim_owner[rim]],
        overhangs.edge_region[edge],
        overhangs.tip_region,
    ]
    points = np.concatenate([inner, rims, edges, vertices[overhangs.tips]])
    face = np.full(len(points), -1, np.int64)
    face[: len(inner) + len(rims)] = np.concatenate([owner, rim_owner[rim]])
    is_inner = np.arange(len(points)) < len(inner)
    return OverhangSamples(points, np.concatenate(region).astype(np.int64), is_inner, face)


def sample_segments(start: Floats, end: Floats, spacing: float) -> tuple[Floats, Int64s]:
    """Return points along segments at most `spacing` mm apart, both ends included, and the segment of each."""
    length = np.linalg.norm(end - start, axis=1)
    pieces = np.maximum(np.ceil(length / spacing), 1).astype(np.int64)
    owner = np.repeat(np.arange(len(pieces)), pieces + 1)
    first = np.concatenate([[0], np.cumsum(pieces + 1)])[:-1]
    fraction = (np.arange(len(owner)) - first[owner]) / pieces[owner]
    return start[owner] + fraction[:, None] * (end - start)[owner], owner


def sample_triangles(corners: Floats, spacing: float) -> Floats:
    """Return points on triangles ``(n, 3, 3)`` mm with their edges and corners, in rows at most `spacing` mm apart."""
    sides = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(sides, axis=2)
    longest = length.argmax(axis=1)
    every = np.arange(len(corners))
    a, b, c = (corners[every, (longest + i) % 3] for i in range(3))
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    rows = np.maximum(np.ceil(area / np.maximum(length.max(axis=1, initial=0.0), 1e-12) / spacing), 1).astype(
        np.int64
    )
    owner = np.repeat(every, rows + 1)
    fraction = (np.arange(len(owner)) - np.repeat(np.cumsum(rows + 1) - rows - 1, rows + 1)) / rows[owner]
    start, end = (each[owner] + fraction[:, None] * (c - each)[owner] for each in (a, b))
    return sample_segments(start, end, spacing)[0]


def triangle_areas(corners: Floats) -> Floats:
    """Return the areas ``(n,)`` mm2 of triangles ``(n, 3, 3)`` mm."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(cross, axis=1) / 2.0)


def _lattice(vertices: Floats, faces: Int64s, spacing: float) -> tuple[Floats, Int64s]:
    from amprep.kernels.meshes.sampling import lattice_points

    corners = np.ascontiguousarray(vertices, np.float64)
    count = lattice_points(corners, faces, spacing, np.empty((0, 3)), np.empty(0, np.int64))
    points, owner = np.empty((count, 3)), np.empty(count, np.int64)
    lattice_points(corners, faces, spacing, points, owner)
    return points, owner


def _rim(faces: Int64s) -> tuple[Int64s, Int64s]:
    """Return the edges ``(n, 2)`` that belong to only one of the faces, and that face."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    key = ends[:, 0] * (int(ends.max(initial=0)) + 1) + ends[:, 1]
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    rim = first[count == 1]
    return ends[rim], rim // 3
