"""Prepare the surface of a part for the search for overhangs: merge coincident vertices, sort half-edges by edge."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int64s

LEVEL = 1e-6
"""Vertices closer than this (mm) are merged, and heights that differ by less are equal."""

ON_PLATE = 1e-3
"""Geometry closer to the plate than this (mm) touches it."""


class Surface(NamedTuple):
    """A mesh with coincident vertices merged and its half-edges sorted by edge.

    Attributes
    ----------
    points
        ``(n, 3)`` mm.
    first
        ``(n,)`` smallest index of each point in the vertices given.
    triangles
        ``(m, 3)`` indices of points.
    edges
        ``(e, 2)`` indices of points.
    half_edge, half_face, opposite
        ``(h,)`` edge and triangle of each half-edge, and the corner of the triangle opposite to it.
    """

    points: Floats
    first: Int64s
    triangles: Int64s
    edges: Int64s
    half_edge: Int64s
    half_face: Int64s
    opposite: Int64s


def merge_vertices(vertices: Floats, triangles: NDArray[Any]) -> Surface:
    """Return the surface of a mesh; degenerate triangles have no half-edges."""
    keys = np.round(vertices / LEVEL).astype(np.int64)
    order = np.lexsort(keys.T[::-1])
    new = np.ones(len(order), np.bool_)
    new[1:] = (keys[order[1:]] != keys[order[:-1]]).any(axis=1)
    merged = np.empty(len(order), np.int64)
    merged[order] = np.cumsum(new) - 1
    first = order[new]  # lexsort is stable: the smallest index of each position
    corners = merged[triangles]
    sound = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    half_face = np.repeat(np.flatnonzero(sound), 3)
    start, end = corners[sound].ravel(), np.roll(corners[sound], -1, axis=1).ravel()
    opposite = np.roll(corners[sound], -2, axis=1).ravel()
    key = np.minimum(start, end) * np.int64(len(first)) + np.maximum(start, end)
    edge_key, half_edge = np.unique(key, return_inverse=True)
    edges = np.column_stack(np.divmod(edge_key, max(len(first), 1)))
    by_edge = np.argsort(half_edge, kind="stable")
    return Surface(
        vertices[first], first, corners, edges, half_edge[by_edge], half_face[by_edge], opposite[by_edge]
    )


def across_halves(surface: Surface, halves: Int64s) -> tuple[Floats, Floats]:
    """Return the directions across half-edges in their faces, and the unit directions along them.

    Parameters
    ----------
    surface
        The surface.
    halves
        ``(k,)`` chosen half-edges; for all of them at once the memory may not suffice.

    Returns
    -------
    across
        ``(k, 3)``, perpendicular to the edge and away from it; the length is the width of the face.
    along
        ``(k, 3)`` unit vectors.
    """
    start, end = (surface.points[surface.edges[surface.half_edge[halves], side]] for side in (0, 1))
    along = end - start
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    ray = surface.points[surface.opposite[halves]] - start
    ray -= np.einsum("ij,ij->i", ray, along)[:, None] * along
    return ray, along


def cross_products(points: Floats, corners: Int64s) -> Floats:
    """Return the cross products of two sides ``(n, 3)``: normals with twice the area as their length."""
    a, b, c = points[corners[:, 0]], points[corners[:, 1]], points[corners[:, 2]]
    return np.asarray(np.cross(b - a, c - a), np.float64)


def unit_normals(surface: Surface) -> Floats:
    """Return unit normals; zero for triangles without area."""
    cross = cross_products(surface.points, surface.triangles)
    size = np.linalg.norm(cross, axis=1, keepdims=True)
    return cross / np.where(size > 0, size, 1.0)


def above_plate(surface: Surface, plate: float) -> Bools:
    """Tell which faces are not entirely on the plate: they reach above the height `plate` (mm)."""
    heights = surface.points[:, 2][surface.triangles]
    return np.asarray(heights.max(axis=1, initial=-np.inf) > plate)
