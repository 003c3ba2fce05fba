"""Decimation of closed meshes by edge collapses of bounded error, and merging of triangles in one plane."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, Ints, MeshArrays
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.geometry.meshes.topology import drop_unused_vertices

Point = tuple[float, float, float]

_ROUNDS = 8
"""Largest number of rounds."""

_LEAST_COSINE = 0.5
"""Least cosine of the angle by which a collapse may turn the normal of a triangle."""

COPLANAR = 1e-6
"""Distance (mm) from a plane within which triangles are in it."""


class _EditableMesh(NamedTuple):
    """Points and their planes, the triangles by number, and the triangles that use each vertex."""

    points: list[Point]
    planes: list[int]
    triangles: dict[int, tuple[int, int, int]]
    users: list[set[int]]


def decimate(points: Floats, triangles: Int64s, tolerance: float, planes: Int64s) -> tuple[Floats, Int64s]:
    """Collapse edges of a closed mesh where each collapse moves the surface by at most a tolerance.

    A round visits the edges from the shortest to the longest and collapses each onto its second end if that is allowed;
    the neighbours of a removed vertex then stay until the next round. The mesh stays closed and keeps its genus (link
    condition: Dey et al. 1999, Publications de l'Institut Mathematique 66), and no triangle turns over.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    tolerance
        Largest distance (mm) of the new position of a vertex from the plane of a triangle around its old one.
    planes
        ``(n,)`` planes that contain each vertex, one bit per plane. A vertex in a plane is never removed, and no
        collapse puts another triangle into a plane.
    """
    surface = _EditableMesh(
        [(float(x), float(y), float(z)) for x, y, z in points],
        [int(each) for each in planes],
        {number: (int(a), int(b), int(c)) for number, (a, b, c) in enumerate(triangles)},
        [set() for _ in points],
    )
    for number, corners in surface.triangles.items():
        for corner in corners:
            surface.users[corner].add(number)
    for _ in range(_ROUNDS):
        if not _round(surface, tolerance):
            break
    return drop_unused_vertices(points, np.array(list(surface.triangles.values()), np.int64).reshape(-1, 3))


def merge_coplanar(vertices: Floats, triangles: Ints) -> MeshArrays | None:
    """Return a closed mesh with fewer triangles in its planes, or None if manifold3d rejects it as a solid.

    The vertices are some of those given, and the surface moves by at most `COPLANAR`. The time is nearly linear in the
    number of triangles.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    """
    solid = as_manifold(vertices, triangles)
    if not accepted(solid) or solid.is_empty():
        return None
    solid = solid.simplify(COPLANAR)  # the first one is large
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties[:, :3], np.float64), np.asarray(mesh.tri_verts, np.int64)


def _round(surface: _EditableMesh, tolerance: float) -> int:
    """Try every free vertex once; return the number of removed vertices."""
    resting = np.array(surface.planes) != 0
    removed = 0
    for vertex, neighbour in _shortest_edges(surface):
        if resting[vertex] or not surface.users[vertex]:
            continue
        if _may_collapse(surface, vertex, neighbour, tolerance):
            resting[list(_around(surface, vertex))] = True
            _collapse(surface, vertex, neighbour)
            removed += 1
    return removed


def _shortest_edges(surface: _EditableMesh) -> list[tuple[int, int]]:
    """Return all directed edges, shortest first."""
    corners = np.array(list(surface.triangles.values()), np.int64)
    edges = np.concatenate([corners[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    points = np.array(surface.points)
    length = np.round(np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1), 9)
    order = np.lexsort([edges[:, 1], edges[:, 0], length])
    return [(int(a), int(b)) for a, b in edges[order]]


def _around(surface: _EditableMesh, vertex: int) -> set[int]:
    return {corner for number in surface.users[vertex] for corner in surface.triangles[number]} - {vertex}


def _may_collapse(surface: _EditableMesh, vertex: int, neighbour: int, tolerance: float) -> bool:
    """Tell whether a vertex may be merged into a neighbour."""
    shared = surface.users[vertex] & surface.users[neighbour]
    if len(shared) != 2 or len(_around(surface, vertex) & _around(surface, neighbour)) != 2:
        return False
    target = surface.points[neighbour]
    for number in surface.users[vertex] - shared:
        corners = surface.triangles[number]
        planes = surface.planes[neighbour]
        for corner in set(corners) - {vertex}:
            planes &= surface.planes[corner]
        if planes:
            return False
        before = [surface.points[corner] for corner in corners]
        after = [target if corner == vertex else surface.points[corner] for corner in corners]
        old, new = _normal(*before), _normal(*after)
        size, length = _dot(old, old) ** 0.5, _dot(new, new) ** 0.5
        if length < 1e-12 or _dot(old, new) < _LEAST_COSINE * size * length:
            return False
        height = _dot(old, _minus(target, before[0]))
        if abs(height) > tolerance * size:
            return False
    return True


def _collapse(surface: _EditableMesh, vertex: int, neighbour: int) -> None:
    for number in list(surface.users[vertex]):
        corners = surface.triangles[number]
        if neighbour in corners:
            for corner in corners:
                surface.users[corner].discard(number)
            del surface.triangles[number]
        else:
            a, b, c = (neighbour if corner == vertex else corner for corner in corners)
            surface.triangles[number] = (a, b, c)
            surface.users[neighbour].add(number)
    surface.users[vertex].clear()


def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _normal(a: Point, b: Point, c: Point) -> Point:
    u, v = _minus(b, a), _minus(c, a)
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
