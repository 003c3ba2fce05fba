"""Prepare shapes for the search of contacts."""

import numpy as np

from amprep.arrays import starts_of
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
            np.concatenate([p.corners for p in pieces]), starts_of([p.corners for p in pieces])
        ).arrays,
        starts_of(shapes.shapes),
        np.concatenate((lo, hi), axis=1),
        np.concatenate([piece.normals for piece in pieces]),
        starts_of([piece.normals for piece in pieces]),
        np.concatenate(reach),
        np.concatenate([piece.edges for piece in pieces]),
        starts_of([piece.edges for piece in pieces]),
        shapes.clearance,
    )
