"""Find knife edges: flat edges from which all faces rise, with the solid above them."""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.faces import ANGLE_TOLERANCE_DEG
from amprep.geometry.overhangs.surface import Surface, across_halves


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
    rise, length = np.abs(end[:, 2] - start[:, 2]), np.linalg.norm(end - start, axis=1)
    possible = rise < length * np.sin(np.radians(max(angle_deg - ANGLE_TOLERANCE_DEG, 0.0)))
    possible &= np.maximum(start[:, 2], end[:, 2]) > plate
    possible[surface.half_edge[overhanging[surface.half_face]]] = False
    del start, end, rise, length  # large where the mesh is
    halves = np.flatnonzero(possible[surface.half_edge])
    ray, _ = across_halves(surface, halves)
    sinks = ray[:, 2] <= 1e-6 * np.linalg.norm(ray, axis=1)
    possible[surface.half_edge[halves[sinks]]] = False
    chosen = np.flatnonzero(possible)
    return chosen[_solid_above(surface, normals, chosen)]


def _solid_above(surface: Surface, normals: Floats, edges: Int64s) -> Bools:
    """Tell for each edge whether the solid is above it.

    In the plane perpendicular to the edge, its faces are rays that rise from it. The solid is above the edge if
    the outside is clockwise of the rightmost ray. The solid counts as above an edge of one face (an open wall).
    """
    position = np.full(len(surface.edges), -1)
    position[edges] = np.arange(len(edges))
    halves = np.flatnonzero(position[surface.half_edge] >= 0)
    group = position[surface.half_edge[halves]]
    ray, tangent = across_halves(surface, halves)
    right = np.cross(tangent, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    up = np.cross(right, tangent)
    across, above = np.einsum("ij,ij->i", ray, right), np.einsum("ij,ij->i", ray, up)
    order = np.lexsort((np.arctan2(above, across), group))
    rightmost = order[np.searchsorted(group[order], np.arange(len(edges)))]
    clockwise = above[rightmost, None] * right[rightmost] - across[rightmost, None] * up[rightmost]
    outside = np.einsum("ij,ij->i", normals[surface.half_face[halves[rightmost]]], clockwise) > 0
    alone = np.bincount(group, minlength=len(edges)) == 1
    return np.asarray(outside | alone)
