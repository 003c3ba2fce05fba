"""Find knife edges: flat edges from which all faces rise, with the solid above them."""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.faces import ANGLE_TOLERANCE_DEG
from amprep.geometry.overhangs.surface import Surface


def knife_edges(
    surface: Surface, normals: Floats, overhanging: Bools, angle_deg: float, plate: float
) -> Int64s:
    """Return the knife edges of a surface, which touch no overhanging face.

    Parameters
    ----------
    surface
        The merged surface.
    normals
        ``(m, 3)`` unit normals of its faces.
    overhanging
        ``(m,)`` bool, overhanging faces.
    angle_deg
        Edges at a smaller angle to the plate are flat.
    plate
        Height (mm) up to which geometry is on the plate.
    """
    start, end = surface.points[surface.edges[:, 0]], surface.points[surface.edges[:, 1]]
    along = end - start
    length = np.linalg.norm(along, axis=1)
    flat = np.abs(along[:, 2]) < length * np.sin(np.radians(max(angle_deg - ANGLE_TOLERANCE_DEG, 0.0)))
    flat &= np.maximum(start[:, 2], end[:, 2]) > plate
    rising = np.ones(len(along), np.bool_)
    rise = surface.points[surface.opposite] - start[surface.half_edge]
    tangent = along / np.maximum(length, 1e-300)[:, None]
    halves = tangent[surface.half_edge]
    ray = rise - np.einsum("ij,ij->i", rise, halves)[:, None] * halves
    size = np.linalg.norm(ray, axis=1)
    sinks = (ray[:, 2] <= 1e-6 * size) | overhanging[surface.half_face]
    rising[surface.half_edge[sinks]] = False
    chosen = np.flatnonzero(flat & rising)
    return chosen[_solid_above(surface, normals, ray, tangent, chosen)]


def _solid_above(surface: Surface, normals: Floats, ray: Floats, tangent: Floats, edges: Int64s) -> Bools:
    """Tell for each edge whether the solid is above it.

    In the plane perpendicular to the edge, its faces are rays that rise from it. The solid is above the edge if
    the outside is clockwise of the rightmost ray. The solid counts as above an edge of one face (an open wall).
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
