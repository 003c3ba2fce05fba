"""Measure the slenderness of supports: height over least width of each disconnected component."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.meshes.topology import merge_equal_vertices
from amprep.model import SupportBody

_DIRECTIONS = 36
"""Number of directions in the horizontal plane in which widths are measured."""


class Slenderness(NamedTuple):
    """Figures of the most slender component of a support body.

    Attributes
    ----------
    pieces
        Number of components; components that share a point are connected.
    slenderness
        Greatest ratio of height to width of a component. The width is that of its projection onto the plate in the
        direction in which this is narrowest.
    height_mm, width_mm, position_mm
        Height, width and centre of the bounding box of that component.
    """

    pieces: int
    slenderness: float
    height_mm: float
    width_mm: float
    position_mm: tuple[float, float, float]


def measure_slenderness(body: SupportBody) -> Slenderness:
    """Return the slenderness of a support body."""
    points, triangles = merge_equal_vertices(np.round(body.mesh.vertices, 4), body.mesh.triangles)
    count, shell = label_shells(triangles, len(points))
    corners = points[triangles]
    volume = np.bincount(
        shell, np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])), count
    )
    pieces = np.flatnonzero((volume > 0.0) | body.surface)  # the others bound voids
    if not len(pieces):
        return Slenderness(0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0))
    piece = np.zeros(len(points), np.int64)
    piece[triangles] = shell[:, None]
    low, high = _extremes(points, piece, count)
    widths = np.full(count, np.inf)
    for angle in np.arange(_DIRECTIONS) * np.pi / _DIRECTIONS:
        least, most = _extremes(points[:, :2] @ [[np.cos(angle)], [np.sin(angle)]], piece, count)
        widths = np.minimum(widths, (most - least)[:, 0])
    heights = (high - low)[:, 2]
    ratio = heights / np.maximum(widths, 1e-6)
    first = int(pieces[ratio[pieces].argmax()])
    x, y, z = ((low + high) / 2)[first].tolist()
    return Slenderness(
        len(pieces), float(ratio[first]), float(heights[first]), float(widths[first]), (x, y, z)
    )


def _extremes(values: Floats, piece: np.ndarray, count: int) -> tuple[Floats, Floats]:
    """Return the least and greatest value of each column of `values` for each piece, ``(count, k)`` each."""
    least, most = np.full((count, values.shape[1]), np.inf), np.full((count, values.shape[1]), -np.inf)
    for axis in range(values.shape[1]):
        np.minimum.at(least[:, axis], piece, values[:, axis])
        np.maximum.at(most[:, axis], piece, values[:, axis])
    return least, most
