"""Widen bounding volumes sideways, so that packing leaves room beside a part."""

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.merging.union import arrays_of
from amprep.geometry.plates.shadow import SEGMENTS, shadow_of
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, Solid
from amprep.model.mesh import Mesh

_CORNERS = 8
"""Sides of the polygon around a disc by which convex pieces are widened."""

_ALONG = 1e-6
"""Components of a direction up to which it is along an axis."""


def widened(volume: BoundingVolume, rotation: Floats, by: float) -> BoundingVolume:
    """Return a volume that contains another one and what is beside it in a build.

    Boxes and convex pieces are widened each. A solid becomes a prism: the outline of its shadow, widened, over its
    height.

    Parameters
    ----------
    volume
        The bounding volume.
    rotation
        ``(3, 3)`` its rotation in the build.
    by
        Distance in plan, mm.
    """
    if isinstance(volume, Boxes):
        side = _reach_along_axes(rotation[2]) * by
        return Boxes(volume.lo - side, volume.hi + side)
    if isinstance(volume, ConvexPieces):
        return ConvexPieces(tuple(_widened_piece(piece, rotation, by) for piece in volume.pieces))
    return _prism(volume, rotation, by)


def _reach_along_axes(up: Floats) -> Floats:
    """Return for each axis whether a horizontal direction can have a component along it; 0 or 1."""
    return np.where(1.0 - np.abs(up) < _ALONG, 0.0, 1.0)


def _widened_piece(piece: Mesh, rotation: Floats, by: float) -> Mesh:
    from manifold3d import Manifold

    angles = 2.0 * np.pi * np.arange(_CORNERS) / _CORNERS
    radius = by / np.cos(np.pi / _CORNERS)
    around = radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(_CORNERS)])
    points = (piece.vertices[:, None] + around @ rotation).reshape(-1, 3)
    return Mesh(*arrays_of(Manifold.hull_points(points)))


def _prism(volume: Solid, rotation: Floats, by: float) -> Solid:
    from manifold3d import JoinType

    points, triangles = volume.mesh.arrays
    turned = points @ rotation.T
    low, high = turned[:, 2].min(), turned[:, 2].max()
    outline = shadow_of(turned, triangles).offset(by, JoinType.Round, 2.0, SEGMENTS).simplify(by / 50.0)
    prism = outline.extrude(float(high - low)).translate((0.0, 0.0, float(low)))
    vertices, corners = arrays_of(prism)
    return Solid(Mesh(vertices @ rotation, corners))
