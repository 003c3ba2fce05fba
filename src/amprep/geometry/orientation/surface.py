"""Prepare the surface of a part for figures in many directions: neighbours, and possible knife edges."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.surface import cross_products, merge_vertices

_STRAIGHT = 1e-3
"""Angles of the solid (radians) that are less by this count as 180 degrees."""

_SHARP = 0.5
"""Cosine of the angle between normals below which an edge may be a knife edge: no less turns both faces steep."""


class TurnableSurface(NamedTuple):
    """A surface without a position: what does not depend on the direction that points up.

    Attributes
    ----------
    points, triangles
        ``(n, 3)`` mm with coincident vertices merged, and ``(m, 3)``; degenerate triangles have no normal.
    normals, areas
        ``(m, 3)`` unit vectors out of the solid and ``(m,)`` mm2.
    beyond
        ``(m, 3)`` for the side from corner i to corner i + 1: 3 times the face beyond it, plus the number of the same
        side there; -1 at open edges and where more than two faces meet.
    straight
        ``(m, 3)`` uint8, 1 where the solid has an angle of at least 180 degrees at the side.
    edges, rays, beside
        ``(e, 2)`` ends of sharp convex edges; ``(e, 2, 3)`` unit vectors in their two faces, away from the edge; and
        ``(e, 2)`` these faces.
    """

    points: Floats
    triangles: Int64s
    normals: Floats
    areas: Floats
    beyond: Int64s
    straight: Int64s
    edges: Int64s
    rays: Floats
    beside: Int64s


def turnable_surface(vertices: Floats, triangles: Int64s) -> TurnableSurface:
    """Return the surface of a mesh.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm, ``(m, 3)``.
    """
    surface = merge_vertices(np.asarray(vertices, np.float64), np.asarray(triangles))
    points, corners = np.ascontiguousarray(surface.points), np.ascontiguousarray(surface.triangles)
    cross = cross_products(points, corners)
    size = np.linalg.norm(cross, axis=1)
    normals = cross / np.where(size > 0.0, size, 1.0)[:, None]
    first, second = _pairs(surface.half_edge)
    one, two = surface.half_face[first], surface.half_face[second]
    side_one, side_two = (
        _side_opposite(corners[face], surface.opposite[half]) for face, half in ((one, first), (two, second))
    )
    beyond = np.full((len(corners), 3), -1, np.int64)
    beyond[one, side_one] = 3 * two + side_two
    beyond[two, side_two] = 3 * one + side_one
    # the solid is at least straight at an edge if the other face does not go behind the plane of this one
    tip = points[surface.opposite[second]]
    start = points[surface.edges[surface.half_edge[first], 0]]
    rise = np.einsum("ij,ij->i", tip - start, normals[one])
    width = np.maximum(np.linalg.norm(tip - start, axis=1), 1e-300)
    at_least_straight = rise >= -_STRAIGHT * width
    straight = np.zeros((len(corners), 3), np.int64)
    straight[one, side_one] = straight[two, side_two] = at_least_straight
    sharp = ~at_least_straight & (np.einsum("ij,ij->i", normals[one], normals[two]) < _SHARP)
    edges = np.ascontiguousarray(surface.edges[surface.half_edge[first[sharp]]])
    rays = np.stack([_rays(points, edges, surface.opposite[half[sharp]]) for half in (first, second)], axis=1)
    return TurnableSurface(
        points,
        corners,
        np.ascontiguousarray(normals),
        size / 2.0,
        beyond,
        straight,
        edges,
        np.ascontiguousarray(rays),
        np.column_stack((one[sharp], two[sharp])),
    )


def _pairs(half_edge: Int64s) -> tuple[Int64s, Int64s]:
    """Return the two half-edges of each edge that has exactly two; half-edges are sorted by edge."""
    count = np.bincount(half_edge) if len(half_edge) else np.zeros(0, np.int64)
    last = np.cumsum(count)
    two: Bools = count == 2
    return last[two] - 2, last[two] - 1


def _side_opposite(corners: Int64s, opposite: Int64s) -> Int64s:
    """Return the number of the side of each triangle that does not touch the corner `opposite`."""
    return np.asarray(((corners == opposite[:, None]).argmax(axis=1) + 1) % 3)


def _rays(points: Floats, edges: Int64s, tips: Int64s) -> Floats:
    """Return the unit vectors from edges to the third corners of their faces, perpendicular to the edges."""
    start = points[edges[:, 0]]
    along = points[edges[:, 1]] - start
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    ray = points[tips] - start
    ray -= np.einsum("ij,ij->i", ray, along)[:, None] * along
    return np.asarray(ray / np.maximum(np.linalg.norm(ray, axis=1), 1e-300)[:, None])
