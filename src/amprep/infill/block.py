"""Build the block of vertical edges that lattice cells replace in a region."""

from itertools import product

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.errors import JobError
from amprep.geometry.voxels.grid import Grid
from amprep.geometry.voxels.voxelise import met_voxels
from amprep.model import CellRequest, Mesh, Role, SupportEdges

MOST_CELLS = 500_000
"""Largest number of cells."""

MOST_VOXELS = 50_000_000
"""Largest number of voxels of the grid over the box of a region."""

DEFAULT_SIZE = 5.0
"""Default size of cells (mm) in regions with room for three of them along each axis."""


def default_size(regions: list[Mesh]) -> float:
    """Return the default size of cells for some regions: 5 mm, or a third of the least side of their boxes."""
    least = min(float(np.ptp(region.bounds, axis=0).min()) for region in regions)
    return min(DEFAULT_SIZE, float(f"{least / 3.0:.2g}"))


def block_over(region: Mesh, *, size: float, height: float, overlap: float, part: Mesh) -> CellRequest:
    """Return a request for cells on vertical edges in all voxels within the overlap of the region.

    The grid is centred on the box of the region, so a region whose sides are multiples of the cell is filled with whole
    cells. All edges have the role trunk, one path and one group; layer 0 is the lowest layer with cells.

    Parameters
    ----------
    region
        The region, a closed mesh.
    size, height
        Size of a cell along x and y, and along z, mm.
    overlap
        Length (mm) by which cells extend beyond the region, at least twice `CONTACT_TOLERANCE`.
    part
        The part, for the request.

    Raises
    ------
    JobError
        When there would be too many cells, or cells narrower than twice the overlap.
    """
    reach = max(overlap, 2.0 * CONTACT_TOLERANCE)
    cell = np.array([size, size, height])
    if cell.min() < 2.0 * reach:
        raise JobError(
            f"cells must be at least {2.0 * reach:g} mm wide and high, twice cells.overlap_mm, got "
            f"{size:g} x {height:g} mm; choose a larger --size"
        )
    origin, count = _grid(region, cell)
    voxels = _near(region, Grid(origin, size, height, (count[2], count[1], count[0])), reach)
    layer, y, x = np.nonzero(voxels)
    if len(x) > MOST_CELLS:
        raise JobError(
            f"a region must have at most {MOST_CELLS} cells, got {len(x)} cells of {size:g} mm; choose a larger --size"
        )
    first = np.array([each.min(initial=count.max()) for each in (x, y, layer)])
    shape = tuple(
        int(each.max(initial=0) - low + 1) for each, low in zip((layer, y, x), first[::-1], strict=True)
    )
    grid = Grid(origin + first * cell, size, height, (shape[0], shape[1], shape[2]))
    one = np.ones_like(x)
    edges = SupportEdges(
        layer - first[2] + 1,
        y - first[1],
        x - first[0],
        direction=np.zeros(len(x), np.uint8),
        flow=one,
        capacity=one,
        group=0 * one,
    )
    return CellRequest(
        grid,
        edges,
        np.full(len(x), Role.TRUNK, np.uint8),
        (part,),
        overlap=overlap,
        allow_surface=False,
        beams=False,
    )


def _grid(region: Mesh, cell: Floats) -> tuple[Floats, np.ndarray]:
    """Return the least corner of a grid centred on the region, and its numbers of voxels: one more on each side."""
    low, high = region.bounds
    count = np.ceil((high - low) / cell - 1e-6) + 2
    if count.prod() > MOST_VOXELS:
        raise JobError(
            f"the grid must have at most {MOST_VOXELS} voxels, got {' x '.join(f'{n:.0f}' for n in count)}; "
            "choose a larger --size"
        )
    return (low + high - count * cell) / 2.0, count.astype(np.int64)


def _near(region: Mesh, grid: Grid, reach: float) -> np.ndarray:
    """Tell which voxels are within `reach` of the region: those that it meets when shifted to the corners of a cube.

    Voxels are at least twice as wide as the reach, so the eight shifted regions meet the same voxels as the region
    enlarged by the reach.
    """
    block = grid.block(*region.bounds, margin=reach + grid.pitch)
    met = np.zeros(grid.shape, np.bool_)
    for shift in product((-reach, reach), repeat=3):
        met[block.slices] |= met_voxels(block, region.vertices + np.array(shift), region.triangles)
    return met
