"""Cells of a grid over a mesh, each with the enclosing box of what the surface has in it."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints


class CellGrid(NamedTuple):
    """A grid over the enclosing box of a mesh.

    Attributes
    ----------
    origin, size
        ``(3,)`` mm least corner, and sides of a cell.
    tight
        ``(nx, ny, nz, 6)`` mm, enclosing box of the surface in each cell; inf and -inf where there is none.
    """

    origin: Floats
    size: Floats
    tight: Floats

    @property
    def met(self) -> Bools:
        """Cells that the surface meets, ``(nx, ny, nz)``."""
        return np.asarray(self.tight[..., 0] <= self.tight[..., 3])

    @property
    def items(self) -> Floats:
        """The enclosing boxes in all cells that the surface meets, ``(m, 6)`` mm; they contain the surface."""
        return self.tight[self.met]


def cells_of(vertices: Floats, triangles: Ints, cells: int) -> CellGrid:
    """Divide the enclosing box of a mesh into cells, `cells` along its longest side."""
    from amprep.kernels.bounding.boxes.tight_cells import tight_cells

    corners = np.ascontiguousarray(triangles, np.int64)
    used = vertices[np.unique(corners)] if len(vertices) > corners.size else vertices
    low, high = used.min(axis=0), used.max(axis=0)
    sides = high - low
    shape = np.maximum(np.ceil(sides / max(sides.max(), 1e-9) * cells - 1e-6), 1).astype(np.int64)
    size = np.maximum(sides / shape, 1e-9)
    tight = np.empty((*(int(n) for n in shape), 6))
    tight_cells(np.ascontiguousarray(vertices), corners, low, size, shape, tight)
    return CellGrid(low, size, tight)


def required_cells(met: Bools, boxes: int) -> Bools:
    """Return the cells that every covering of the given ones with at most `boxes` boxes contains.

    Strategy: a box that does not contain a point lies beyond it along some axis, and can meet only one of the six
    rays along the axes from the point. If rays in more than `boxes` of the six directions meet cells that must be
    covered, the point is covered. This adds the interior of a solid for up to five boxes, and the inside of a
    cup for up to four. It is repeated until nothing is added.

    Parameters
    ----------
    met
        ``(nx, ny, nz)``.
    boxes
        At most 5.
    """
    required = met
    while True:
        blocked = np.zeros(met.shape, np.int64)
        for axis in range(3):
            blocked += np.logical_or.accumulate(required, axis=axis)
            blocked += np.flip(np.logical_or.accumulate(np.flip(required, axis), axis=axis), axis)
        grown = required | (blocked > boxes)
        if grown.sum() == required.sum():
            return grown
        required = grown


def snapped(grid: CellGrid, boxes: Floats) -> Int64s:
    """Return the smallest blocks of cells that contain boxes ``(k, 6)``, as first cell and cell past the end."""
    limit = np.array(grid.tight.shape[:3])
    low = np.floor((boxes[:, :3] - grid.origin) / grid.size + 1e-9)
    high = np.ceil((boxes[:, 3:] - grid.origin) / grid.size - 1e-9)
    return np.hstack((np.clip(low, 0, limit), np.clip(high, 0, limit))).astype(np.int64)


def in_mm(grid: CellGrid, blocks: Ints) -> Floats:
    """Return blocks of cells ``(k, 6)`` as boxes in mm."""
    return np.hstack((grid.origin + blocks[:, :3] * grid.size, grid.origin + blocks[:, 3:] * grid.size))
