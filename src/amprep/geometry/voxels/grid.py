"""The voxel grid of a build, and blocks of its voxels."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, frozen


@dataclass(frozen=True, eq=False)
class Grid:
    """Position and size of the voxels of a build.

    Voxel (k, y, x) extends by one voxel size upwards from ``origin + (x, y, k) * (pitch, pitch, step)``.
    Plane p has the height ``origin[2] + p * step``; square (p, y, x) is the bottom of voxel (p, y, x).

    Attributes
    ----------
    origin
        ``(3,)`` mm, the smallest corner; z is 0, the plate, in a support grid.
    pitch, step
        Horizontal and vertical size of a voxel, mm.
    shape
        Numbers of voxels ``(nz, ny, nx)``.
    """

    origin: Floats
    pitch: float
    step: float
    shape: tuple[int, int, int]

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", frozen(self.origin, np.float64))

    @property
    def size(self) -> Floats:
        """``(3,)`` mm, size of a voxel along x, y, z."""
        return np.array([self.pitch, self.pitch, self.step])

    def block(self, lo: Floats, hi: Floats, margin: float = 0.0) -> "VoxelBlock":
        """Return the voxels that the box from `lo` to `hi`, widened horizontally by `margin` mm, can touch."""
        size = self.size
        wide = np.array([margin, margin, 0.0])
        first = np.floor((lo - wide - self.origin) / size).astype(np.int64) - 1
        last = np.ceil((hi + wide - self.origin) / size).astype(np.int64) + 1
        limit = np.array(self.shape[::-1])
        first, last = np.clip(first, 0, limit), np.clip(last, 0, limit)
        x, y, z = ((int(a), int(b)) for a, b in zip(first, np.maximum(first, last), strict=True))
        return VoxelBlock(self, (z[0], y[0], x[0]), (z[1] - z[0], y[1] - y[0], x[1] - x[0]))


class VoxelBlock(NamedTuple):
    """A block of voxels of a grid: its first voxel (k, y, x) and its shape (nz, ny, nx)."""

    grid: Grid
    first: tuple[int, int, int]
    shape: tuple[int, int, int]

    @property
    def slices(self) -> tuple[slice, slice, slice]:
        """Index of the block in an array over the whole grid."""
        k, y, x = (slice(a, a + n) for a, n in zip(self.first, self.shape, strict=True))
        return k, y, x

    def relative(self, points: Floats) -> Floats:
        """Return `points` (mm) relative to the smallest corner of the block."""
        corner = self.grid.origin + np.array(self.first[::-1]) * self.grid.size
        return np.ascontiguousarray(points - corner, np.float64)
