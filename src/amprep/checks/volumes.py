"""Check the volume maker's promise: the bounding volume contains the part with its interior."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.checks.packing.motion import motion_fault
from amprep.checks.violation import Violation
from amprep.geometry.meshes.distance import box_solids, convex_solid, thickness
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, TurnedVolume
from amprep.model.mesh import Mesh
from amprep.model.part import Part

if TYPE_CHECKING:
    from manifold3d import Manifold

_NEGLIGIBLE_MM3 = 1e-9


def check_volume(part: Part, volume: BoundingVolume | TurnedVolume) -> list[Violation]:
    """Return a violation if the part extends more than `CONTACT_TOLERANCE` beyond the bounding volume.

    The interior of a solid must be covered as well, and a mesh that bounds must be closed. For a part that is not a
    solid, the triangles must be covered. The rotation of a turned volume must be the identity, as that of a plain
    volume, or one of the orientations that the part allows.
    """
    if isinstance(volume, TurnedVolume):
        turned = not np.array_equal(volume.rotation, np.eye(3))
        if turned and (fault := motion_fault(volume.rotation, part.orientations)):
            return [Violation("allowed motion", part.name, f"the rotation of its bounding volume {fault}")]
        mesh = Mesh(part.mesh.vertices @ volume.rotation.T, part.mesh.triangles)
        return check_volume(replace(part, mesh=mesh), volume.volume)
    if isinstance(volume, Boxes) and len(volume.lo) == 1:
        return _in_one_box(part, volume)
    cover = _cover(volume)
    if not accepted(cover):
        return [
            Violation("volume is closed", part.name, "the mesh of its bounding volume is not a closed solid")
        ]
    return _left_out(part, volume, cover)


def _left_out(part: Part, volume: BoundingVolume, cover: "Manifold") -> list[Violation]:
    """Return a violation if something of the part is outside the cover.

    A thin remainder of a solid is within the tolerance. Triangles are always thin, so the cover is enlarged for them.
    """
    solid = part.is_solid
    outside = _solid(part) - cover if solid else _triangle_prisms(part, volume) - _enlarged(volume, cover)
    if outside.is_empty() or outside.volume() <= _NEGLIGIBLE_MM3:
        return []
    if solid and not isinstance(volume, Boxes) and thickness(outside) <= CONTACT_TOLERANCE:
        return []
    box = outside.bounding_box()
    return [_violation(part, f"{outside.volume():.3g} mm3 of the part", np.array(box[:3]), np.array(box[3:]))]


def _in_one_box(part: Part, volume: Boxes) -> list[Violation]:
    least, most = part.mesh.bounds
    if (least >= volume.lo[0] - CONTACT_TOLERANCE).all() and (most <= volume.hi[0] + CONTACT_TOLERANCE).all():
        return []
    reach = max(float((volume.lo[0] - least).max()), float((most - volume.hi[0]).max()))
    return [_violation(part, f"up to {reach:.4g} mm of the part", least, most)]


def _violation(part: Part, amount: str, least: Floats, most: Floats) -> Violation:
    place = " to ".join(
        "(" + ", ".join(f"{c:.3f}" for c in corner.tolist()) + ")" for corner in (least, most)
    )
    return Violation(
        "volume contains part",
        part.name,
        f"the bounding volume does not contain {amount}, in the box {place} mm",
    )


def _cover(volume: BoundingVolume) -> "Manifold":
    """Return the volume as a solid. Boxes are enlarged by the tolerance, which also closes rounding gaps."""
    from manifold3d import Manifold, OpType

    if isinstance(volume, Boxes):
        return box_solids(volume.lo - CONTACT_TOLERANCE, volume.hi + CONTACT_TOLERANCE)
    if isinstance(volume, ConvexPieces):
        return Manifold.batch_boolean([convex_solid(piece.vertices) for piece in volume.pieces], OpType.Add)
    return as_manifold(volume.mesh.vertices, volume.mesh.triangles)


def _enlarged(volume: BoundingVolume, cover: "Manifold") -> "Manifold":
    """Return the cover enlarged by the tolerance, as cubes enlarge its pieces or its surface; boxes already are."""
    from manifold3d import Manifold, OpType

    if isinstance(volume, Boxes):
        return cover
    if isinstance(volume, ConvexPieces):
        convex = [piece.vertices for piece in volume.pieces]
    else:
        convex = list(volume.mesh.vertices[volume.mesh.triangles])
    cube = CONTACT_TOLERANCE * np.array(list(product((-1.0, 1.0), repeat=3)))
    grown = [convex_solid((points[:, None] + cube).reshape(-1, 3)) for points in convex]
    return Manifold.batch_boolean([cover, *grown], OpType.Add)


def _solid(part: Part) -> "Manifold":
    return as_manifold(part.mesh.vertices, part.mesh.triangles)


def _vertices_inside(vertices: Floats, volume: BoundingVolume) -> Iterator[Bools]:
    """Yield for each box or convex piece which vertices are in it, up to `CONTACT_TOLERANCE`."""
    if isinstance(volume, Boxes):
        for least, most in zip(volume.lo - CONTACT_TOLERANCE, volume.hi + CONTACT_TOLERANCE, strict=True):
            yield ((vertices >= least) & (vertices <= most)).all(axis=1)
    if isinstance(volume, ConvexPieces):
        for piece in volume.pieces:
            hull = convex_solid(piece.vertices).to_mesh64()
            corners = hull.vert_properties[:, :3][hull.tri_verts]
            normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            length = np.linalg.norm(normal, axis=1)
            normal, level = normal[length > 0], np.einsum("ij,ij->i", normal, corners[:, 0])[length > 0]
            inside = np.full(len(vertices), len(level) > 0)
            for n, reach in zip(normal, level + CONTACT_TOLERANCE * length[length > 0], strict=True):
                inside &= vertices @ n <= reach
            yield inside


def _triangle_prisms(part: Part, volume: BoundingVolume) -> "Manifold":
    """Return the triangles that no single box or convex piece contains, as thin prisms."""
    from manifold3d import Manifold, OpType

    held = np.zeros(len(part.mesh.triangles), dtype=bool)
    for inside in _vertices_inside(part.mesh.vertices, volume):
        held |= inside[part.mesh.triangles].all(axis=1)
    corners = part.mesh.vertices[part.mesh.triangles[~held]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    corners, normal, length = corners[length > 0], normal[length > 0], length[length > 0]
    offset = 0.1 * CONTACT_TOLERANCE * (normal / length[:, None])[:, None]
    prisms = [convex_solid(prism) for prism in np.concatenate((corners - offset, corners + offset), axis=1)]
    return Manifold.batch_boolean(prisms, OpType.Add) if prisms else Manifold()
