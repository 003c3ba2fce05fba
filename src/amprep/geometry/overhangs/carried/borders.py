"""Find the borders of overhang regions along which the part carries them."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.carried.facets import facets_of
from amprep.geometry.overhangs.regions import components_of_faces
from amprep.geometry.overhangs.surface import Surface, across_halves

_STRAIGHT = np.pi - 1e-3
"""Least angle (radians) of the solid at an edge along which the part carries a region."""

_DOWN = 1e-6
"""Least descent of a face from an edge, as a fraction of its width, that counts as going down."""


class RegionFaces(NamedTuple):
    """The overhanging faces of a surface in regions, prepared for walks over them.

    Attributes
    ----------
    face
        ``(m,)`` their indices in the surface.
    label
        ``(m,)`` region of each.
    corners
        ``(m, 3, 3)`` mm, counter-clockwise seen from above.
    beyond
        ``(m, 3)`` as in `amprep.kernels.overhangs.walks.WalkableFaces`.
    anchors
        ``(a, 2, 2)`` mm in plan: segments along which the part or the plate carries regions.
    anchor_label
        ``(a,)`` region of each.
    outer, outer_normal, outer_label
        ``(b, 3)`` mm: corners of the facets, beyond the border, along which the part carries regions; the normals of
        these; and the regions.
    """

    face: Int64s
    label: Int64s
    corners: Floats
    beyond: Int64s
    anchors: Floats
    anchor_label: Int64s
    outer: Floats
    outer_normal: Floats
    outer_label: Int64s


def region_faces(
    surface: Surface, normals: Floats, overhanging: Bools, plate: float, base: Bools | None = None
) -> RegionFaces:
    """Return the faces of overhang regions, with what is beyond their sides.

    The part carries a region along an edge if the face on the other side goes down from the edge and the solid has
    an angle of at least 180 degrees there. Along edges on the plate, and where faces reach down to the plate, the
    plate carries it; along the rim of a base, the base does.

    Parameters
    ----------
    surface, normals
        The merged surface and its unit normals.
    overhanging
        ``(m,)`` bool, the faces of the regions.
    plate
        Height (mm) up to which geometry is on the plate.
    base
        ``(m,)`` bool, overhanging faces that carry those beside them.
    """
    from amprep.kernels.overhangs.walks import ANCHOR, FREE

    own = np.flatnonzero(overhanging[surface.half_face])
    partner = _partners(surface, normals)[own]
    position = np.cumsum(overhanging) - 1
    faces = np.flatnonzero(overhanging)
    beyond = np.full((len(faces), 3), FREE, np.int64)
    row, column = position[surface.half_face[own]], 2 - _sides(surface, own)
    paired = partner >= 0
    inner = paired & overhanging[surface.half_face[partner]]
    from_base = np.zeros(len(own), np.bool_)
    if base is not None:
        from_base = inner & base[surface.half_face[partner]] & ~base[surface.half_face[own]]
        inner &= ~from_base
    across = partner[inner]
    beyond[row[inner], column[inner]] = 3 * position[surface.half_face[across]] + 2 - _sides(surface, across)
    ends = surface.edges[surface.half_edge[own]]
    anchored = surface.points[ends, 2].max(axis=1) <= plate
    rim = np.flatnonzero(paired & ~inner & ~from_base)
    rim = rim[_goes_down(surface, normals, own[rim], partner[rim])]
    anchored[rim] = True
    anchored |= from_base
    anchored &= ~inner
    beyond[row[anchored], column[anchored]] = ANCHOR
    label = components_of_faces(surface, overhanging)
    corners = surface.points[surface.triangles[faces]][:, [0, 2, 1]]
    contact, contact_label = _plate_contact(corners, label, plate)
    beside = facets_of(surface, normals, surface.half_face[partner[rim]], label[row[rim]])
    return RegionFaces(
        faces,
        label,
        np.ascontiguousarray(corners),
        beyond,
        np.concatenate([surface.points[ends[anchored], :2], contact]),
        np.concatenate([label[row[anchored]], contact_label]),
        surface.points[surface.triangles[beside.face]].reshape(-1, 3),
        np.repeat(normals[beside.face], 3, axis=0),
        np.repeat(beside.label, 3),
    )


def _sides(surface: Surface, halves: Int64s) -> Int64s:
    """Return the numbers ``(k,)`` of half-edges in their faces: side i goes from corner i to corner i + 1."""
    corners = surface.triangles[surface.half_face[halves]]
    return np.asarray(((corners == surface.opposite[halves, None]).argmax(axis=1) + 1) % 3, np.int64)


def _partners(surface: Surface, normals: Floats) -> Int64s:
    """Return for each half-edge the one on the other side of the solid at its edge, or -1 at an open edge."""
    count = np.bincount(surface.half_edge)[surface.half_edge] if len(surface.half_edge) else surface.half_edge
    partner = np.full(len(surface.half_edge), -1, np.int64)
    two = np.flatnonzero(count == 2)
    partner[two] = two.reshape(-1, 2)[:, ::-1].ravel()
    many = np.flatnonzero(count > 2)
    for group in np.split(many, np.flatnonzero(np.diff(surface.half_edge[many])) + 1):
        for half in group.tolist():
            others = group[group != half]
            angle = _solid_angle(surface, normals, np.full(len(others), half), others)
            partner[half] = others[angle.argmin()]
    return partner


def _solid_angle(surface: Surface, normals: Floats, one: Int64s, other: Int64s) -> Floats:
    """Return the angles (radians) through the solid from faces to others at the same edges, by their half-edges."""
    inwards = -normals[surface.half_face[one]]
    (ray, _), (beside, _) = across_halves(surface, one), across_halves(surface, other)
    across = np.einsum("ij,ij->i", beside, ray) / np.maximum(np.linalg.norm(ray, axis=1), 1e-300)
    deep = np.einsum("ij,ij->i", beside, inwards)
    return np.asarray(np.arctan2(deep, across) % (2 * np.pi))


def _goes_down(surface: Surface, normals: Floats, one: Int64s, other: Int64s) -> Bools:
    """Tell where the face of the other half-edge goes down from the edge and the solid lies beyond it.

    The solid lies beyond it at an angle of 180 degrees or more, and above faces that point down. At such an angle
    faces that point up are below the region, even if they are level or rise.
    """
    ray, _ = across_halves(surface, other)
    down = ray[:, 2] < -_DOWN * np.linalg.norm(ray, axis=1)
    beyond = _solid_angle(surface, normals, one, other) >= _STRAIGHT
    facing = normals[surface.half_face[other], 2]
    return np.asarray((down & (beyond | (facing < -_DOWN))) | (beyond & (facing > _DOWN)))


def _plate_contact(corners: Floats, label: Int64s, plate: float) -> tuple[Floats, Int64s]:
    """Return the segments ``(k, 2, 2)`` in plan at which faces reach down to the plate, and their regions."""
    low = corners[:, :, 2] <= plate
    crossing = np.flatnonzero(low.any(axis=1) & ~low.all(axis=1))
    found = np.empty((len(crossing), 2, 2))
    for n, (face, inside) in enumerate(zip(corners[crossing], low[crossing], strict=True)):
        sides = [(i, (i + 1) % 3) for i in range(3) if inside[i] != inside[(i + 1) % 3]]
        for end, (i, j) in enumerate(sides):
            share = (plate - face[i, 2]) / (face[j, 2] - face[i, 2])
            found[n, end] = face[i, :2] + share * (face[j, :2] - face[i, :2])
    return found, label[crossing]
