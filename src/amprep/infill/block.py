"""The block of upright edges that fills a region with lattice cells."""

from itertools import product

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.errors import JobError
from amprep.geometry.voxels.grid import Grid
from amprep.geometry.voxels.voxelise import met_voxels
from amprep.model import CellRequest, Mesh, Role, SupportEdges

MOST_CELLS = 500_000
MOST_CUBES = 50_000_000

USUAL_SIZE = 5.0
"""mm; the size of cells unless asked for, where a region has room for three of them on each side."""


def usual_size(regions: list[Mesh]) -> float:
    """Return the size of cells that suits all regions: 5 mm, or a third of the least side of their boxes."""
    least = min(float(np.ptp(region.bounds, axis=0).min()) for region in regions)
    return min(USUAL_SIZE, float(f"{least / 3.0:.2g}"))


def block_over(region: Mesh, *, size: float, height: float, overlap: float, part: Mesh) -> CellRequest:
    """Return upright edges for all cubes that come within `overlap` mm of the region.

    The grid is centred on the region's box, so that one whose sides are multiples of the cell is filled by whole
    cells. All edges are trunks of one group and one path; layer 0 is the lowest with cells.

    Parameters
    ----------
    size, height
        mm, of a cell along x and y, and along z.
    overlap
        mm; less than `CONTACT_TOLERANCE` counts as twice that, so that cells on a face of the region reach over it.

    Raises
    ------
    JobError
        When there would be too many cells, or cells less than twice the overlap wide.
    """
    reach = max(overlap, 2.0 * CONTACT_TOLERANCE)
    cell = np.array([size, size, height])
    if cell.min() < 2.0 * reach:
        raise JobError(
            f"cells are at least {2.0 * reach:g} mm wide and high, twice cells.overlap_mm, got "
            f"{size:g} x {height:g} mm; choose a larger --size"
        )
    origin, count = _grid(region, cell)
    cubes = _near(region, Grid(origin, size, height, (count[2], count[1], count[0])), reach)
    layer, y, x = np.nonzero(cubes)
    if len(x) > MOST_CELLS:
        raise JobError(
            f"{len(x)} cells of {size:g} mm are too many, at most {MOST_CELLS} are possible; choose a larger --size"
        )
    first = np.array([each.min(initial=count.max()) for each in (x, y, layer)])
    shape = tuple(
        int(each.max(initial=0) - low + 1) for each, low in zip((layer, y, x), first[::-1], strict=True)
    )
    frame = Grid(origin + first * cell, size, height, (shape[0], shape[1], shape[2]))
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
        frame,
        edges,
        np.full(len(x), Role.TRUNK, np.uint8),
        (part,),
        overlap=overlap,
        allow_surface=False,
        beams=False,
    )


def _grid(region: Mesh, cell: Floats) -> tuple[Floats, np.ndarray]:
    """Return the least corner of a grid centred on the region, and its cubes along x, y, z: one more on each side."""
    low, high = region.bounds
    count = np.ceil((high - low) / cell - 1e-6) + 2
    if count.prod() > MOST_CUBES:
        raise JobError(
            f"a grid of {' x '.join(f'{n:.0f}' for n in count)} cells is too fine; choose a larger --size"
        )
    return (low + high - count * cell) / 2.0, count.astype(np.int64)


def _near(region: Mesh, grid: Grid, reach: float) -> np.ndarray:
    """Tell which cubes come within `reach` of the region: those that it meets when moved to eight sides.

    Cubes are at least twice as wide as the reach, so together the eight are the region widened by it.
    """
    block = grid.block(*region.bounds, margin=reach + grid.pitch)
    met = np.zeros(grid.shape, np.bool_)
    for way in product((-reach, reach), repeat=3):
        met[block.slices] |= met_voxels(block, region.vertices + np.array(way), region.triangles)
    return met
