"""Close the voxels that other supports take: those of earlier passes of planning, and finished ones."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bytes, Floats
from amprep.geometry.voxels.grid import Grid
from amprep.geometry.voxels.voxelise import met_voxels
from amprep.model.mesh import Mesh
from amprep.model.supports import Voxel
from amprep.supports.layout import SupportLayout


class TakenSpace(NamedTuple):
    """Boxes that contain the supports of earlier passes; `lo` and `hi` are ``(n, 3)`` mm."""

    lo: Floats
    hi: Floats


def taken_by(layouts: Sequence[SupportLayout]) -> TakenSpace:
    """Return the boxes of all voxels that layouts use: along their edges, and in the columns of their connectors."""
    lo, hi = [np.empty((0, 3))], [np.empty((0, 3))]
    for layout in layouts:
        grid = layout.grid
        voxels = np.unique(layout.edges.voxels, axis=0)
        lo.append(grid.origin + voxels[:, ::-1] * grid.size)
        hi.append(lo[-1] + grid.size)
        square, rise = layout.red.square[layout.connected], layout.red.rise[layout.connected]
        lo.append(grid.origin + square[:, ::-1] * grid.size)
        height = np.zeros((len(rise), 3))
        height[:, 2] = rise * grid.step
        hi.append(lo[-1] + grid.size + height)
    return TakenSpace(np.concatenate(lo), np.concatenate(hi))


def close_taken(voxels: Bytes, grid: Grid, taken: TakenSpace) -> None:
    """Close the free voxels whose interior meets a box; `voxels` is modified in place."""
    first = np.floor((taken.lo + CONTACT_TOLERANCE - grid.origin) / grid.size).astype(np.int64)
    last = np.ceil((taken.hi - CONTACT_TOLERANCE - grid.origin) / grid.size).astype(np.int64)
    limit = np.array(grid.shape[::-1])
    first, last = np.clip(first, 0, limit), np.clip(last, 0, limit)
    met = np.zeros(grid.shape, np.bool_)
    for (x, y, z), (x_end, y_end, z_end) in zip(first.tolist(), last.tolist(), strict=True):
        met[z:z_end, y:y_end, x:x_end] = True
    voxels[met & (voxels == Voxel.FREE)] = Voxel.CLOSED


def close_met(voxels: Bytes, grid: Grid, meshes: Sequence[Mesh]) -> None:
    """Close the free voxels whose interior meets a mesh of a support; `voxels` is modified in place."""
    for mesh in meshes:
        block = grid.block(*mesh.bounds)
        inside = voxels[block.slices]
        inside[met_voxels(block, *mesh.arrays) & (inside == Voxel.FREE)] = Voxel.CLOSED
