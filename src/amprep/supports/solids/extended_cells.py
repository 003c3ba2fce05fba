"""Extend cells from red squares up to the part."""

from collections.abc import Iterator

import numpy as np

from amprep.arrays import Bools, Floats, Ints, MeshArrays
from amprep.cells.instances import CellInstances, expand_cells
from amprep.geometry.cells.tiling import Tiles, tile
from amprep.model import Grid
from amprep.model.supports.edges import square_keys
from amprep.supports.layout import SupportLayout


def extended_cells(
    instances: CellInstances, chosen: Bools, seat: Floats, layout: SupportLayout
) -> Iterator[MeshArrays]:
    """Yield closed meshes of the cells above red squares, and of one more cell below each square.

    Parameters
    ----------
    instances
        Answer of the cell emitter, with connector edges above red squares.
    chosen
        ``(n,)`` instances to expand.
    seat
        ``(m,)`` mm, depth at which connectors begin below each red square; where it is 0 no cell is added below.
    layout
        The red squares.
    """
    yield from expand_cells(instances, chosen)
    lowest = np.flatnonzero(chosen & on_red(instances, layout, seat > 0.0))
    cells, request = instances.cells, instances.request
    edge = cells.edge[lowest]
    voxel = request.edges.upper[edge][:, ::-1].astype(np.int64) - (0, 0, 2)
    voxel, first = np.unique(voxel, axis=0, return_index=True)
    template = cells.template[lowest][first].astype(np.int64)
    yield from tile(instances.templates, _upright(template, voxel, request.grid))


def _upright(template: Ints, voxel: Ints, grid: Grid) -> Tiles:
    """Return upright templates in the voxels ``(n, 3)`` x, y, layer."""
    size = np.array([grid.pitch, grid.pitch, grid.step])
    matrix = np.zeros((len(voxel), 3, 4))
    matrix[:, [0, 1, 2], [0, 1, 2]] = size
    matrix[:, :, 3] = grid.origin + voxel * size
    return Tiles(template, voxel, matrix)


def on_red(instances: CellInstances, layout: SupportLayout, chosen: Bools) -> Bools:
    """Tell which instances have one of the chosen red squares at their lower end."""
    request, edge = instances.request, instances.cells.edge
    lower = square_keys(request.edges.upper - (1, 0, 0))[edge]
    return np.isin(lower, square_keys(layout.red.square[chosen]))
