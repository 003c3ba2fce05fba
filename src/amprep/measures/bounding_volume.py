"""Measure bounding volumes: volume of the union, highest point, and number of elements."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.boxes.build_space import union_volume
from amprep.geometry.meshes.distance import convex_solid
from amprep.geometry.meshes.shells import measure_shells, solid_volume
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, Solid
from amprep.model.part import Part

if TYPE_CHECKING:
    from manifold3d import Manifold

EQUAL_VOLUME = 1e-9
"""Fraction by which boxes may be larger than the part that they equal."""

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=bool)


def volume_of(volume: BoundingVolume) -> float:
    """Return the volume of a bounding volume, mm3: overlaps of boxes, pieces or shells count once."""
    if isinstance(volume, Boxes):
        return union_volume(volume.lo, volume.hi)
    if isinstance(volume, ConvexPieces):
        return float(_united(volume).volume())
    vertices, triangles = volume.mesh.arrays
    return solid_volume(vertices, triangles, measure_shells(vertices, triangles))


def points_of(volume: BoundingVolume) -> Floats:
    """Return points ``(n, 3)`` mm whose convex hull contains the volume: corners of boxes, or vertices."""
    if isinstance(volume, Boxes):
        pairs = zip(volume.lo, volume.hi, strict=True)
        return np.concatenate([np.where(_CORNERS, hi, lo) for lo, hi in pairs])
    if isinstance(volume, ConvexPieces):
        return np.concatenate([piece.vertices for piece in volume.pieces])
    return volume.mesh.vertices


def is_part_itself(volume: BoundingVolume, part: Part) -> bool:
    """Return whether a bounding volume has the part's own mesh, or is boxes of no more volume than the part."""
    if isinstance(volume, Boxes):
        return part.is_solid and volume_of(volume) <= part.volume_mm3 * (1.0 + EQUAL_VOLUME)
    return isinstance(volume, Solid) and volume.mesh is part.mesh and part.is_solid


def kind_of_volumes(volumes: Iterable[BoundingVolume]) -> str:
    """Return what volumes are, in words: ``enclosing boxes``, ``boxes``, ``convex pieces``, ``bounding volumes``."""
    kinds = {(type(volume), count_pieces(volume) > 1) for volume in volumes}
    if kinds == {(Boxes, False)}:
        return "enclosing boxes"
    types = {kind for kind, _ in kinds}
    return "boxes" if types == {Boxes} else "convex pieces" if types == {ConvexPieces} else "bounding volumes"


def count_pieces(volume: BoundingVolume) -> int:
    """Return the number of boxes or convex pieces; 1 for a solid."""
    if isinstance(volume, Boxes):
        return len(volume.lo)
    return len(volume.pieces) if isinstance(volume, ConvexPieces) else 1


def _united(volume: ConvexPieces) -> "Manifold":
    from manifold3d import Manifold, OpType

    return Manifold.batch_boolean([convex_solid(piece.vertices) for piece in volume.pieces], OpType.Add)
