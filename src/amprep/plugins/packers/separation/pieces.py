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

MOST_CURVED, CURVED_EXCESS = 12, 0.03
"""Largest number of pieces of a solid with many faces, and the excess up to which fewer are preferred."""

MOST_POLYHEDRA = 60_000
"""Number of pairs of pieces that the shapes of a problem may have together; each takes some 2 kB and 0.1 ms."""


def most_pieces(shapes: int) -> int:
    """Return how many pieces each of some shapes may have, so that all have at most `MOST_POLYHEDRA` pairs."""
    return max(1, int(np.sqrt(2.0 * MOST_POLYHEDRA) / max(shapes, 1)))


def convex_pieces_of(volume: BoundingVolume, most: int, stop: Stop) -> list[Floats]:
    """Return for each convex piece of a volume its corners ``(k, 3)`` mm; the pieces contain the volume.

    `most` is the number of pieces that a solid may have. A solid of few faces and pieces is decomposed exactly, another
    one into pieces that contain it.
    """
    if isinstance(volume, Boxes):
        boxes = zip(volume.lo, volume.hi, strict=True)
        return [np.array(list(product(*zip(lo, hi, strict=True)))) for lo, hi in boxes]
    if isinstance(volume, ConvexPieces):
        return [extreme_points(piece.vertices) for piece in volume.pieces]
    return _pieces_of_mesh(volume.mesh, most, stop)


def _pieces_of_mesh(mesh: Mesh, most: int, stop: Stop) -> list[Floats]:
    hull = extreme_points(mesh.vertices)
    exact = exact_pieces(mesh.vertices, mesh.triangles, stop) if len(mesh.triangles) <= MOST_FACES else None
    if exact is not None and len(exact) <= min(most, MOST_EXACT):
        return exact
    solid = as_manifold(mesh.vertices, mesh.triangles)
    if most == 1 or solid.volume() <= 0.0:
        return [hull]
    goal = PieceGoal(min(most, MOST_CURVED), CURVED_EXCESS)
    return [extreme_points(points) for points in decompose_by_cuts(solid, goal, stop)]
