"""Map points of a build to pixels of a picture and back, in orthographic views."""

from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np

from amprep.arrays import Floats


@dataclass(frozen=True, eq=False)
class Camera:
    """Maps build coordinates in mm to column and row in pixels and depth in mm, away from the viewer.

    Attributes
    ----------
    axes
        ``(3, 3)``, rows: right, down, away from the viewer.
    offset
        ``(3,)`` offset of column, row and depth.
    pixels_per_mm
        Scale of column and row.
    """

    axes: Floats
    offset: Floats
    pixels_per_mm: float

    def project(self, points: Floats) -> Floats:
        """Return ``(n, 3)`` column, row, depth of ``(n, 3)`` points."""
        scale = np.array([self.pixels_per_mm, self.pixels_per_mm, 1.0])
        # a product of matrices takes several threads, which wait for one another actively
        seen: Floats = np.einsum("ij,kj->ik", points, self.axes * scale[:, None]) + self.offset
        return seen

    @property
    def matrix(self) -> Floats:
        """``(3, 4)``: build coordinates to column, row, depth."""
        scale = np.array([self.pixels_per_mm, self.pixels_per_mm, 1.0])
        return np.column_stack([self.axes * scale[:, None], self.offset])

    @property
    def inverse(self) -> Floats:
        """``(3, 4)``: column, row, depth to build coordinates."""
        turn = np.linalg.inv(self.matrix[:, :3])
        return np.column_stack([turn, -turn @ self.offset])


def view_axes(azimuth_deg: float, elevation_deg: float) -> Floats:
    """Return the axes of a camera at `azimuth_deg` (from +x, counter-clockwise) that looks down by `elevation_deg`."""
    azimuth, elevation = radians(azimuth_deg), radians(elevation_deg)
    away = -np.array([cos(azimuth) * cos(elevation), sin(azimuth) * cos(elevation), sin(elevation)])
    right = np.array([-sin(azimuth), cos(azimuth), 0.0])
    return np.array([right, np.cross(away, right), away])


def fitted(axes: Floats, points: Floats, size: tuple[int, int], margin: float) -> Camera:
    """Return the camera that shows all points in the middle of a picture.

    Parameters
    ----------
    axes
        ``(3, 3)``, see `Camera`.
    points
        ``(n, 3)`` mm.
    size, margin
        Width and height, and the free border, in pixels.
    """
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    extent = np.maximum(high - low, 1e-6)
    scale = float(min((size[0] - 2 * margin) / extent[0], (size[1] - 2 * margin) / extent[1]))
    middle = (low + high) / 2
    offset = np.array([size[0] / 2 - scale * middle[0], size[1] / 2 - scale * middle[1], 0.0])
    return Camera(axes, offset, scale)


def box_corners(low: Floats, high: Floats) -> Floats:
    """Return the ``(8, 3)`` corners of a box."""
    return np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )
