"""Find the edges of overhang regions, and the anchors among them: where the part itself carries a region."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.overhangs.surface import LEVEL, MergedMesh, labels
from amprep.geometry.meshes.containment import inside

_STEPS = (0.01, 0.05)
"""Distances (mm) beyond a border at which the judge looks for the solid."""


class RegionEdges(NamedTuple):
    """Edges of the faces of overhang regions.

    Attributes
    ----------
    start, end
        ``(e, 3)`` mm.
    region
        ``(e,)`` region of the edge.
    is_border, is_anchor
        ``(e,)`` bool, whether only one face of the region has the edge, and whether the part carries it there.
    """

    start: Floats
    end: Floats
    region: Int64s
    is_border: Bools
    is_anchor: Bools


def regions_of(surface: MergedMesh, faces: Int64s) -> Int64s:
    """Label faces; faces that share an edge belong to the same region."""
    return labels(surface.edge[faces].reshape(-1), np.repeat(np.arange(len(faces)), 3), len(faces))


def region_edges(
    surface: MergedMesh, faces: Int64s, region: Int64s, angle: float, plate: float, *, strict: bool = False
) -> RegionEdges:
    """Return the edges of overhang regions, with those parts of edges that are on the plate as anchors.

    An edge at the border is an anchor if the face on its other side goes down from it and the angle of the solid is
    at least 180 degrees there, or if the solid is found a little beyond and below it; either suffices, because the
    judge must not take the part's own support away.

    Parameters
    ----------
    surface
        The part.
    faces, region
        ``(f,)`` overhanging triangles and their regions.
    angle
        Overhang angle, radians.
    plate
        Height up to which geometry is on the plate, mm.
    strict
        Whether only what certainly carries the region is an anchor: where more than two triangles share an edge, two
        solids may only touch there.
    """
    edge = surface.edge[faces].reshape(-1)
    number, first, count = np.unique(edge, return_index=True, return_counts=True)
    face = faces[first // 3]
    start, end = (surface.points[surface.ends[number, side]] for side in (0, 1))
    is_border = count == 1
    is_anchor = np.zeros(len(number), np.bool_)
    is_joint = np.bincount(surface.edge.reshape(-1), minlength=len(surface.ends))[number] > 2
    rows = np.flatnonzero(is_border & ~(is_joint & strict))
    is_anchor[rows] = _turns_down(surface, faces, number[rows], face[rows])
    rows = rows[~is_anchor[rows]]
    is_anchor[rows] = _solid_beyond(surface, start[rows], end[rows], face[rows], angle)
    edges = RegionEdges(start, end, region[first // 3], is_border, is_anchor)
    return _with_plate(edges, plate)


def _turns_down(surface: MergedMesh, faces: Int64s, number: Int64s, face: Int64s) -> Bools:
    """Tell at which border edges another face goes down and the solid has at least 180 degrees.

    An edge of more than two faces has several others; one of them suffices.
    """
    others = np.setdiff1d(np.arange(len(surface.triangles)), faces)
    position = np.full(len(surface.ends), -1)
    position[number] = np.arange(len(number))
    border = position[surface.edge[others]].reshape(-1)
    opposite = np.roll(surface.triangles[others], -2, axis=1).reshape(-1)[border >= 0]
    border = border[border >= 0]
    start, end = (surface.points[surface.ends[number[border], side]] for side in (0, 1))
    along = end - start
    ray = surface.points[opposite] - start
    square = np.maximum(np.einsum("ij,ij->i", along, along), LEVEL**2)
    ray -= (np.einsum("ij,ij->i", ray, along) / square)[:, None] * along
    height = np.linalg.norm(ray, axis=1)
    out = np.einsum("ij,ij->i", ray, surface.normal[face[border]]) >= -1e-4 * height
    turns = np.zeros(len(number), np.bool_)
    turns[border[out & (height > LEVEL) & (ray[:, 2] < -LEVEL * height)]] = True
    return turns


def _solid_beyond(surface: MergedMesh, start: Floats, end: Floats, face: Int64s, angle: float) -> Bools:
    """Tell beyond which edges, horizontally away from the region and a little lower, the solid is."""
    middle = (start + end) / 2.0
    centre = surface.points[surface.triangles[face]].mean(axis=1)
    away = np.stack([end[:, 1] - start[:, 1], start[:, 0] - end[:, 0]], axis=1)
    away /= np.maximum(np.linalg.norm(away, axis=1), LEVEL)[:, None]
    away *= np.sign(np.einsum("ij,ij->i", away, (middle - centre)[:, :2]))[:, None]
    found = np.zeros(len(start), np.bool_)
    for step in _STEPS:
        down = np.full((len(start), 1), -0.5 * step * np.tan(angle))
        points = middle + np.hstack([step * away, down])
        found |= inside(points, surface.points, surface.triangles.astype(np.int32))
    return found


def _with_plate(edges: RegionEdges, plate: float) -> RegionEdges:
    """Add the stretches of edges that are at most `plate` mm high as anchors."""
    low, high = edges.start[:, 2] <= plate, edges.end[:, 2] <= plate
    on_plate = low & high
    rows = np.flatnonzero(low != high)
    a, b = edges.start[rows], edges.end[rows]
    fraction = (plate - a[:, 2]) / (b[:, 2] - a[:, 2])
    cut = a + fraction[:, None] * (b - a)
    up = low[rows][:, None]
    start, end = np.where(up, a, cut), np.where(up, cut, b)
    no = np.zeros(len(rows), np.bool_)
    stretches = RegionEdges(start, end, edges.region[rows], no, ~no)
    known = edges._replace(is_border=edges.is_border | on_plate, is_anchor=edges.is_anchor | on_plate)
    return RegionEdges(*(np.concatenate(each) for each in zip(known, stretches, strict=True)))
