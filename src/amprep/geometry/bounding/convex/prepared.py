"""Convex pieces prepared for queries: flat arrays of their extreme points, boxes and planes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s, frozen

if TYPE_CHECKING:
    from amprep.kernels.bounding.gjk import PieceArrays


@dataclass(frozen=True, eq=False)
class PreparedPieces:
    """Convex pieces in flat arrays; copies of a part under rigid motions use one of these.

    Attributes
    ----------
    vertices
        ``(n, 3)`` mm, extreme points of all pieces, piece by piece.
    first
        ``(p + 1,)`` index of the first vertex of each piece, and n.
    """

    vertices: Floats
    first: Int64s

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, np.float64, 3))
        object.__setattr__(self, "first", frozen(self.first, np.int64))

    @property
    def pieces(self) -> list[Floats]:
        """The extreme points ``(k, 3)`` of each piece."""
        return np.split(self.vertices, self.first[1:-1])

    @cached_property
    def arrays(self) -> "PieceArrays":
        """The arrays for the kernels, with the boxes of the pieces and of the set."""
        from amprep.kernels.bounding.gjk import PieceArrays

        corners = [(piece.min(axis=0), piece.max(axis=0)) for piece in (*self.pieces, self.vertices)]
        lo, hi = np.array([c[0] for c in corners]), np.array([c[1] for c in corners])
        half = frozen((hi - lo) / 2 * (1.0 + 1e-12), np.float64)
        return PieceArrays(self.vertices, self.first, frozen((lo + hi) / 2, np.float64), half)

    @cached_property
    def planes(self) -> tuple[Floats, ...]:
        """For each piece the planes ``(k, 4)`` of its faces: outward unit normal n and offset d, n x <= d inside."""
        return tuple(planes_of(piece) for piece in self.pieces)


def prepare_pieces(pieces: Sequence[Floats], shrink: float = 0.0) -> PreparedPieces:
    """Prepare convex pieces for queries.

    Parameters
    ----------
    pieces
        For each piece points ``(k, 3)`` mm whose convex hull it is.
    shrink
        Each piece is scaled about its mean point so that no point moves by more than this length, mm. Pieces that
        penetrate one another by less than about this length then do not collide.
    """
    kept = [_scaled(extreme_points(np.asarray(piece, np.float64)), shrink) for piece in pieces]
    first = np.cumsum([0] + [len(piece) for piece in kept])
    return PreparedPieces(np.concatenate(kept) if kept else np.empty((0, 3)), first)


def _scaled(points: Floats, shrink: float) -> Floats:
    middle = points.mean(axis=0)
    reach = float(np.linalg.norm(points - middle, axis=1).max())
    factor = 1.0 - min(1.0, shrink / reach) if reach > 0.0 else 1.0
    return np.asarray(middle + (points - middle) * factor)


def extreme_points(points: Floats) -> Floats:
    """Return the corners of the convex hull of points ``(n, 3)``; all points if they are in one plane."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except (QhullError, ValueError):
        return points


def planes_of(points: Floats) -> Floats:
    """Return the planes ``(k, 4)`` of a convex hull: outward unit normals and offsets; of its box if it is flat.

    Every point is behind every plane, also after rounding.
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        normals = ConvexHull(points).equations[:, :3]
    except (QhullError, ValueError):
        normals = np.concatenate((np.eye(3), -np.eye(3)))
    _, chosen = np.unique(np.round(normals, 9), axis=0, return_index=True)
    normals = normals[np.sort(chosen)]
    return np.column_stack((normals, (points @ normals.T).max(axis=0)))
