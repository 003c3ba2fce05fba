"""Bounding volume of nearly convex pieces (thesis 2.5)."""

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.decompose import PieceGoal, decompose_by_cuts, decompose_by_patches
from amprep.geometry.bounding.convex.hulls import containing_hull
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model.bounding_volume import ConvexPieces
from amprep.model.control import Stop
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.plugins.volumes.params import ConvexPiecesParams


def convex_pieces(
    part: Part,
    *,
    params: ConvexPiecesParams,
    rng: np.random.Generator,  # noqa: ARG001
    stop: Stop,
) -> ConvexPieces:
    """Return convex pieces whose union contains the part with its interior.

    Closed cavities of the part are filled. A part that is not a solid is decomposed by patches of its surface.
    """
    return ConvexPieces(tuple(Mesh(*containing_hull(points)) for points in _points(part, params, stop)))


def _points(part: Part, params: ConvexPiecesParams, stop: Stop) -> list[Floats]:
    goal = PieceGoal(params.pieces, params.excess, params.concavity_mm)
    solid = as_manifold(part.mesh.vertices, part.mesh.triangles)
    if not part.is_solid or solid.volume() <= 0.0:
        return decompose_by_patches(part.mesh.arrays, None, goal, stop)
    if params.method == "surface":
        return decompose_by_patches(part.mesh.arrays, solid, goal, stop)
    return decompose_by_cuts(solid, goal, stop)
