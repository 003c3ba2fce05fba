"""Decompose a solid into convex pieces: by cuts, or from patches of its surface."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, MeshArrays
from amprep.geometry.bounding.convex.cells import cells_of, hull_corners
from amprep.geometry.bounding.convex.merge import merge_cells
from amprep.geometry.bounding.convex.recursive_cuts import cut_into_cells
from amprep.geometry.bounding.convex.surface_patches import convex_patches

if TYPE_CHECKING:
    from manifold3d import Manifold

CELLS_A_PIECE = 4
"""Number of cells that are cut for each piece before cells are merged."""

LEAST_CELLS = 8
"""Number of cells up to which a solid is cut in any case."""

CUT_FRACTION = 0.1
"""Part of the permitted excess at which cutting ends; merging uses the rest."""

CONCAVITY_FRACTION = 0.02
"""Largest concavity of a surface patch, as a fraction of the diagonal of the part, unless a length is given."""


@dataclass(frozen=True)
class PieceGoal:
    """What the pieces should be like.

    Attributes
    ----------
    pieces
        Largest number of pieces.
    excess
        Excess of the total volume of the pieces over the volume of the solid, as a fraction of it, up to which
        fewer pieces are preferred.
    concavity
        Cells and patches may be as concave as this, mm; 0 for the default of the method.
    """

    pieces: int
    excess: float
    concavity: float = 0.0


def decompose_by_cuts(solid: "Manifold", goal: PieceGoal, stop: Callable[[], bool]) -> list[Floats]:
    """Return for each piece the points ``(k, 3)`` of which it is the convex hull; together the hulls contain the solid.

    Cavities are filled. At least one piece is made, and after an early end there may be more than `goal.pieces`.
    """
    volume = sum(cell.solid.volume() for cell in cells_of(solid))
    most = max(LEAST_CELLS, CELLS_A_PIECE * goal.pieces)
    cells = cut_into_cells(solid, most, CUT_FRACTION * goal.excess * volume, goal.concavity, stop)
    return merge_points([cell.vertices for cell in cells], goal, volume, stop)


def decompose_by_patches(
    mesh: MeshArrays, solid: "Manifold | None", goal: PieceGoal, stop: Callable[[], bool]
) -> list[Floats]:
    """Return pieces as `decompose_by_cuts` does, from nearly convex patches of the surface (thesis 2.5).

    The hulls of the patches contain the surface. The interior that they leave uncovered is cut into cells, whose
    hulls are added. Then pieces are merged.

    Parameters
    ----------
    mesh
        Vertices and triangles of the surface.
    solid
        The solid; None for a surface without interior.
    goal, stop
        See `decompose_by_cuts`.
    """
    vertices, triangles = mesh
    diagonal = float(np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0)))
    epsilon = goal.concavity or CONCAVITY_FRACTION * diagonal
    patches = convex_patches(vertices, triangles, epsilon, stop)
    if patches is None:
        return [cell.vertices for cell in cells_of(solid)] if solid else [vertices]
    points = [vertices[np.unique(triangles[patch])] for patch in patches]
    volume = solid.volume() if solid else 0.0
    if solid:
        inner = solid - _union(points)
        most = max(LEAST_CELLS, CELLS_A_PIECE * goal.pieces)
        cells = cut_into_cells(inner, most, CUT_FRACTION * goal.excess * volume, epsilon, stop)
        points += [cell.vertices for cell in cells]
    return merge_points(points, goal, volume, stop)


def _union(points: Sequence[Floats]) -> "Manifold":
    from manifold3d import Manifold, OpType

    return Manifold.batch_boolean([Manifold.hull_points(each) for each in points], OpType.Add)


def merge_points(
    points: list[Floats], goal: PieceGoal, volume: float, stop: Callable[[], bool]
) -> list[Floats]:
    """Merge sets of points, each of which stands for its hull; see `merge_cells`."""
    groups = merge_cells(
        [hull_corners(each) for each in points], goal.pieces, (1.0 + goal.excess) * volume, stop
    )
    return [np.concatenate([points[k] for k in group]) for group in groups]
