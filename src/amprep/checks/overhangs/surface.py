"""Meshes with coincident vertices merged, in which the judges search for overhangs."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.model.mesh import Mesh

LEVEL = 1e-6
"""Heights (mm) that differ by less are equal."""


class MergedMesh(NamedTuple):
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


def faces_down(surface: MergedMesh, on_plate: float) -> Bools:
    """Tell which triangles face downwards and are not within `on_plate` mm of the plate."""
    above = surface.points[surface.triangles, 2].max(axis=1, initial=-np.inf) > on_plate
    return np.asarray(above & (surface.normal[:, 2] < -LEVEL))


def surface_of(mesh: Mesh) -> MergedMesh:
    """Return a mesh with coincident vertices merged."""
    _, first, merged = np.unique(np.round(mesh.vertices, 6), axis=0, return_index=True, return_inverse=True)
    points, triangles = mesh.vertices[first], merged.reshape(-1)[mesh.triangles].astype(np.int64)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    size = np.linalg.norm(cross, axis=1)
    normal = cross / np.where(size > 0, size, 1.0)[:, None]
    pairs = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    ends, edge = np.unique(pairs, axis=0, return_inverse=True)
    return MergedMesh(points, triangles, first, normal, size / 2, ends, edge.reshape(-1, 3))


def labels(node: Int64s, member: Int64s, count: int) -> Int64s:
    """Label `count` members; members that share a node have the same label."""
    _, number = np.unique(node, return_inverse=True)
    nodes = int(number.max(initial=-1)) + 1
    return components(number.reshape(-1), member + nodes, nodes + count)[nodes:]


def components(one: Int64s, other: Int64s, count: int) -> Int64s:
    """Label the connected components of a graph of `count` nodes with edges `one`-`other`."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def large_enough(label: Int64s, measure: Floats, smallest: float) -> Bools:
    """Tell which members belong to components of at least the smallest measure, up to rounding."""
    return np.asarray(np.bincount(label, weights=measure)[label] >= smallest * (1.0 + 1e-6))
