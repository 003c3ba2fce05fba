"""Convex pieces of bounding volumes."""

from itertools import product

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.decompose import PieceGoal, decompose_by_cuts
from amprep.geometry.bounding.convex.prepared import extreme_points
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.no_fit.partition import MOST_FACES, exact_pieces
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces
from amprep.model.control import Stop
from amprep.model.mesh import Mesh

MOST_EXACT = 20
"""Number of exact pieces up to which a solid is packed exactly; work grows with the square of the number."""

CURVED = PieceGoal(pieces=12, excess=0.03)
"""Pieces of a solid with many faces: fine enough that small parts fit into the hollows of large ones."""


def convex_pieces_of(volume: BoundingVolume, stop: Stop) -> list[Floats]:
    """Return for each convex piece of a volume its corners ``(k, 3)`` mm; the pieces contain the volume.

    A solid of few faces and pieces is decomposed exactly, another one into pieces that contain it.
    """
    if isinstance(volume, Boxes):
        boxes = zip(volume.lo, volume.hi, strict=True)
        return [np.array(list(product(*zip(lo, hi, strict=True)))) for lo, hi in boxes]
    if isinstance(volume, ConvexPieces):
        return [extreme_points(piece.vertices) for piece in volume.pieces]
    return _pieces_of_mesh(volume.mesh, stop)


def _pieces_of_mesh(mesh: Mesh, stop: Stop) -> list[Floats]:
    hull = extreme_points(mesh.vertices)
    exact = exact_pieces(mesh.vertices, mesh.triangles, stop) if len(mesh.triangles) <= MOST_FACES else None
    if exact is not None and len(exact) <= MOST_EXACT:
        return exact
    solid = as_manifold(mesh.vertices, mesh.triangles)
    if solid.volume() <= 0.0:
        return [hull]
    return [extreme_points(points) for points in decompose_by_cuts(solid, CURVED, stop)]
