"""Cells of a grid that a solid meets, with the extreme points and the volume of the solid in each."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int32s, Int64s
from amprep.geometry.bounding.grid_cuts.planes import grid_planes, snapped
from amprep.kernels.bounding.grid_cuts.records import ClippedSurface, GridCells, GridPlanes


@dataclass(frozen=True, eq=False)
class SolidCells:
    """A solid in the cells of a grid, scaled so that the box around it is a unit cube.

    Attributes
    ----------
    cells
        The cells.
    surface, owner
        ``(k, 3)`` points of the surface in all cells, and ``(k,)`` the cell of each.
    low, size
        ``(3,)`` mm, least corner and sides of the box.
    moved
        Distance (mm) by which vertices were moved into planes of the grid.
    """

    cells: GridCells
    surface: Floats
    owner: Int32s
    low: Floats
    size: Floats
    moved: float

    def in_mm(self, points: Floats) -> Floats:
        """Return points ``(n, 3)`` in mm."""
        return self.low + points * self.size

    def points_by_cell(self) -> "PointsByCell":
        """Return the points of the surface cell by cell."""
        order = np.argsort(self.owner, kind="stable")
        first = np.searchsorted(self.owner[order], np.arange(len(self.cells.place) + 1))
        return PointsByCell(self.surface[order], first)


class PointsByCell(NamedTuple):
    """Points ``(k, 3)`` cell by cell, and the first of each cell, ``(n + 1,)``."""

    points: Floats
    first: Int64s

    def of(self, cells: Int32s) -> Floats:
        """Return the points of some cells."""
        start, count = self.first[cells], np.diff(self.first)[cells]
        shift = np.repeat(start - np.concatenate(([0], np.cumsum(count)[:-1])), count)
        return np.asarray(self.points[shift + np.arange(len(shift))])


def cells_of_solid(vertices: Floats, triangles: Int64s) -> SolidCells:
    """Divide a solid into the cells of a grid.

    Parameters
    ----------
    vertices, triangles
        A closed mesh, ``(n, 3)`` mm and ``(m, 3)``.
    """
    low = vertices.min(axis=0)
    size = np.maximum(np.ptp(vertices, axis=0), 1e-9)
    planes = grid_planes(vertices, triangles)
    moved = snapped(vertices, planes)
    distance = float(np.linalg.norm(moved - vertices, axis=1).max())
    points = (moved - low) / size
    planes = GridPlanes(*((planes[k] - low[k]) / size[k] for k in range(3)))
    shape = tuple(len(each) - 1 for each in planes)
    surface = _clip(points, triangles, planes)
    inside = _corners_inside(points, triangles, planes)
    met = inside[..., 0].copy()
    met.ravel()[surface.cells] = True
    volume = _volumes(surface, planes)
    _fill_cavities(met, inside, volume, planes)
    number = np.full(shape, -1, np.int32)
    number[met] = np.arange(met.sum(), dtype=np.int32)
    place = np.argwhere(met).astype(np.int32)
    owner = number.ravel()[surface.cells]
    first, kept = _extremes(surface.points, owner, place, planes)
    lattice = np.stack(np.meshgrid(*planes, indexing="ij"), axis=-1).reshape(-1, 3)
    bits = np.packbits(inside[met], axis=1, bitorder="little").ravel()
    both = np.concatenate((surface.points[kept], lattice))
    cells = GridCells(place, number, first, both, bits, volume[met])
    return SolidCells(cells, surface.points, owner, low, size, distance)


def _fill_cavities(met: Bools, inside: Bools, volume: Floats, planes: GridPlanes) -> None:
    """Add the cells that no way over empty cells joins with the outside."""
    from scipy.ndimage import label

    empty, _ = label(np.pad(~met, 1, constant_values=True))
    closed = (empty != empty[0, 0, 0])[1:-1, 1:-1, 1:-1] & ~met
    sides = np.diff(planes.x)[:, None, None] * np.diff(planes.y)[:, None] * np.diff(planes.z)
    met[closed], inside[closed], volume[closed] = True, True, sides[closed]


def _extremes(points: Floats, owner: Int32s, place: Int32s, planes: GridPlanes) -> tuple[Int64s, Int32s]:
    """Return the first extreme point of each cell, and the extreme points of all cells, cell by cell."""
    from amprep.kernels.bounding.grid_cuts.clip import extremes_of_cells

    low = np.column_stack([planes[k][place[:, k]] for k in range(3)])
    size = np.column_stack([np.diff(planes[k])[place[:, k]] for k in range(3)])
    index = np.empty((len(place), 26), np.int32)
    extremes_of_cells(points, owner, low, size, index)
    index.sort(axis=1)
    new = np.diff(index, axis=1, prepend=-1) > 0
    return np.concatenate(([0], np.cumsum(new.sum(axis=1)))).astype(np.int64), index[new]


def _clip(points: Floats, triangles: Int64s, planes: GridPlanes) -> ClippedSurface:
    from amprep.kernels.bounding.grid_cuts.clip import clip_to_cells

    count = int(np.prod([len(each) - 1 for each in planes]))
    room = 3 * len(triangles) + 4000
    while True:
        area, volume = np.zeros(count), np.zeros(count)
        surface = ClippedSurface(np.empty((room, 3)), np.empty(room, np.int64), area, volume)
        used = clip_to_cells(points, triangles, planes, surface)
        if used >= 0:
            return surface._replace(points=surface.points[:used], cells=surface.cells[:used])
        room *= 2


def _corners_inside(points: Floats, triangles: Int64s, planes: GridPlanes) -> Bools:
    """Return for each cell which of its corners are in the solid, if moved a little into the cell."""
    from amprep.kernels.bounding.grid_cuts.clip import count_at_corners

    x, y, z = (len(each) for each in planes)
    change = np.zeros((2, 2, 2, x, y, z), np.int16)
    count_at_corners(points, triangles, planes, change)
    inside = np.cumsum(change, axis=-1, dtype=np.int16) > 0
    corners = [
        inside[i, j, k, i : x - 1 + i, j : y - 1 + j, k : z - 1 + k]
        for i in (0, 1)
        for j in (0, 1)
        for k in (0, 1)
    ]
    return np.stack(corners, axis=-1)


def _volumes(surface: ClippedSurface, planes: GridPlanes) -> Floats:
    """Return the volume of the solid in each cell."""
    shape = tuple(len(each) - 1 for each in planes)
    area, volume = surface.area.reshape(shape), surface.volume.reshape(shape)
    above = np.flip(np.cumsum(np.flip(area, 2), axis=2), 2) - area
    return volume + above * np.diff(planes.z)
