"""Inflation of convex pieces by a clearance: polyhedra that contain every point within the clearance."""

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.prepared import PreparedPieces, planes_of, prepare_pieces

# Strategy. The points within the clearance c of a convex piece are the intersection of the half-spaces n x <= h(n) +
# c over all directions n, where h is the support function of the piece. Any choice of directions gives a polyhedron
# that contains these points. The normals of the faces alone leave long spikes at sharp corners, so while a corner of
# the polyhedron is farther from the piece than the reach allows, the plane is added that is normal to the way from
# the piece to the corner.

ROUNDING = 1e-9
"""Length (mm) by which the planes are moved outward beyond the clearance."""

ROUNDS = 20
"""Largest number of rounds of cuts; in practice 1 to 4 are made."""


def inflate_piece(points: Floats, clearance: float, reach: float = 1.2) -> Floats:
    """Return the corners ``(m, 3)`` of a convex polyhedron that contains all within the clearance of a convex piece.

    Parameters
    ----------
    points
        ``(n, 3)`` mm; the piece is their convex hull.
    clearance
        Above 0, mm.
    reach
        Above 1: no corner of the polyhedron is farther from the piece than `reach` times the clearance.
    """
    piece = prepare_pieces([points])
    axes = np.concatenate((np.eye(3), -np.eye(3)))
    normals = np.concatenate((planes_of(piece.vertices)[:, :3], axes))
    for _ in range(ROUNDS):
        corners = _corners(piece.vertices, normals, clearance + ROUNDING)
        away = _vectors_from(piece, corners)
        far = np.linalg.norm(away, axis=1)
        if not (far > reach * clearance).any():
            break
        cut = away[far > reach * clearance]
        normals = np.concatenate((normals, cut / np.linalg.norm(cut, axis=1)[:, None]))
        _, chosen = np.unique(np.round(normals, 6), axis=0, return_index=True)
        normals = normals[np.sort(chosen)]
    return corners


def inflate_pieces(pieces: PreparedPieces, clearance: float, reach: float = 1.2) -> PreparedPieces:
    """Inflate every piece of a set; see `inflate_piece`. Without clearance the set is returned."""
    if clearance <= 0.0:
        return pieces
    return prepare_pieces([inflate_piece(piece, clearance, reach) for piece in pieces.pieces])


def _corners(points: Floats, normals: Floats, clearance: float) -> Floats:
    from scipy.spatial import HalfspaceIntersection

    offsets = (points @ normals.T).max(axis=0) + clearance
    found = HalfspaceIntersection(np.column_stack((normals, -offsets)), points.mean(axis=0))
    return np.unique(np.round(found.intersections, 12), axis=0)


def _vectors_from(piece: PreparedPieces, points: Floats) -> Floats:
    """Return the vectors ``(n, 3)`` from a piece to points outside it."""
    from amprep.kernels.bounding.piece_sets import COLUMNS, SIMPLEX_ROWS, vectors_from

    single = PreparedPieces(points, np.arange(len(points) + 1))
    found = np.empty_like(points)
    work = np.empty((SIMPLEX_ROWS, COLUMNS))
    vectors_from(piece.arrays, 0, single.arrays, np.eye(4), work, found)
    return found
