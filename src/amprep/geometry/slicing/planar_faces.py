"""Group the triangles of a mesh to planar faces."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.overhangs.surface import Surface, cross_products, merge_vertices, unit_normals

_BEND = 1e-3
"""Angle (radians) between neighbouring triangles up to which they belong to one planar face."""


class PlanarFaces(NamedTuple):
    """The planar faces of a mesh.

    Attributes
    ----------
    points, triangles
        ``(n, 3)`` mm with coincident vertices merged; ``(m, 3)`` indices.
    label
        ``(m,)`` number of the planar face of each triangle.
    normal
        ``(k, 3)`` unit normal of each planar face; zero for faces without area.
    """

    points: Floats
    triangles: Int64s
    label: Int64s
    normal: Floats


def find_planar_faces(vertices: Floats, triangles: Int64s) -> PlanarFaces:
    """Return the planar faces: triangles that are connected by edges at which the surface does not bend.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)`` indices.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    surface = merge_vertices(vertices, triangles)
    a, b = _flat_neighbours(surface)
    count = len(surface.triangles)
    graph = coo_array((np.ones(len(a), np.int8), (a, b)), shape=(count, count))
    faces, label = connected_components(graph, directed=False)
    normal = np.zeros((faces, 3))
    np.add.at(normal, label, cross_products(surface.points, surface.triangles))
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    return PlanarFaces(
        surface.points, surface.triangles, label.astype(np.int64), normal / np.where(size > 0.0, size, 1.0)
    )


def _flat_neighbours(surface: Surface) -> tuple[Int64s, Int64s]:
    """Return the triangles on both sides of each edge that has two, where the surface does not bend."""
    edge, face = surface.half_edge, surface.half_face
    starts = np.flatnonzero(np.concatenate([[True], edge[1:] != edge[:-1]])) if len(edge) else edge
    sides = np.diff(np.concatenate([starts, [len(edge)]]))
    first = starts[sides == 2]
    a, b = face[first], face[first + 1]
    normal = unit_normals(surface)
    flat = np.einsum("ij,ij->i", normal[a], normal[b]) > np.cos(_BEND)
    return a[flat], b[flat]
