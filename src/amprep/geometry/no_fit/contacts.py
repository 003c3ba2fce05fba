"""Prepare shapes for the search of contacts."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.bounding.convex.prepared import PreparedPieces
from amprep.geometry.no_fit.pieces import ShapeSet
from amprep.kernels.no_fit.records import ContactShapes


def contact_shapes(shapes: ShapeSet) -> ContactShapes:
    """Return the pieces of shapes in flat arrays."""
    pieces = [piece for shape in shapes.shapes for piece in shape]
    lo, hi = shapes.boxes
    reach = [(piece.corners @ piece.normals.T).max(axis=0) for piece in pieces]
    return ContactShapes(
        PreparedPieces(
            np.concatenate([p.corners for p in pieces]), _starts([p.corners for p in pieces])
        ).arrays,
        _starts(shapes.shapes),
        np.concatenate((lo, hi), axis=1),
        np.concatenate([piece.normals for piece in pieces]),
        _starts([piece.normals for piece in pieces]),
        np.concatenate(reach),
        np.concatenate([piece.edges for piece in pieces]),
        _starts([piece.edges for piece in pieces]),
        shapes.clearance,
    )


def _starts(groups: Sequence[Sequence[object] | Floats]) -> Int64s:
    """Return the index of the first row of each group among the rows of all, and the number of rows."""
    return np.cumsum([0] + [len(group) for group in groups]).astype(np.int64)
