"""Meshes of bounding volumes for pictures and 3D views."""

import numpy as np

from amprep.arrays import Floats
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces
from amprep.model.mesh import Mesh

_CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=bool)
_TRIANGLES = np.array(
    [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
     [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]], np.int32,
)  # fmt: skip


def meshes_of(volume: BoundingVolume) -> tuple[Mesh, ...]:
    """Return one closed mesh for each box or convex piece, or the mesh of the solid."""
    if isinstance(volume, Boxes):
        return tuple(box_mesh(lo, hi) for lo, hi in zip(volume.lo, volume.hi, strict=True))
    return volume.pieces if isinstance(volume, ConvexPieces) else (volume.mesh,)


def box_mesh(lo: Floats, hi: Floats) -> Mesh:
    """Return a box with the corners `lo` and `hi` ``(3,)`` as a mesh of 12 triangles."""
    return Mesh(np.where(_CORNERS, hi, lo), _TRIANGLES)
