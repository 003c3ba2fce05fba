"""A lattice of random cells on a grid, and a cell of 200 triangles for it."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Ints, MeshArrays
from amprep.model import DIRECTIONS

_FILLED = 0.55
"""Fraction of the grid's voxels that contain a vertical cell."""


@dataclass(frozen=True, eq=False)
class CellLayout:
    """Cells on a grid: upper squares ``(n, 3)`` x, y, layer, and offsets ``(n, 2)`` of their lower squares."""

    square: Ints
    shift: Ints

    @property
    def junctions(self) -> float:
        """Fraction of the cells that share a voxel of the grid with another cell."""
        oblique = np.flatnonzero(self.shift.any(axis=1))
        lower = self.square[oblique] + np.pad(self.shift[oblique], ((0, 0), (0, 1)))
        cell = np.concatenate([np.arange(len(self.square)), oblique])
        _, voxel, count = np.unique(
            np.concatenate([self.square, lower]), axis=0, return_inverse=True, return_counts=True
        )
        meets = np.zeros(len(self.square), np.bool_)
        meets[cell[count[voxel.reshape(-1)] > 1]] = True
        return float(meets.mean())


def random_layout(cells: int, oblique: float, seed: int) -> CellLayout:
    """Return cells at random places of a cubic grid.

    Parameters
    ----------
    cells
        Number of cells.
    oblique
        Fraction of the cells that lead to a neighbouring square; the others are vertical.
    seed
        Seed of the random numbers.
    """
    rng = np.random.default_rng(seed)
    leaning = int(cells * oblique)
    side = int(np.ceil(np.cbrt((cells - leaning) / _FILLED)))
    place = rng.permutation(side**3)[: cells - leaning]
    upright = np.column_stack([place % side, place // side % side, place // side**2])
    edge = rng.permutation(4 * side**3)[:leaning]
    direction, place = np.divmod(edge, side**3)
    tilted = np.column_stack([place % side, place // side % side, place // side**2])
    towards = np.array(DIRECTIONS, np.int64)[1 + direction][:, ::-1]
    square = np.concatenate([upright, tilted])
    shift = np.concatenate([np.zeros_like(upright[:, :2]), towards])
    return CellLayout(square.astype(np.int64), shift.astype(np.int64))


def barrel(sides: int = 6, rings: int = 17) -> MeshArrays:
    """Return a post in the unit cube that is thicker in the middle; it has 200 triangles by default."""
    height = np.linspace(0.0, 1.0, rings)
    radius = 0.2 + 0.08 * np.sin(np.pi * height) ** 2
    turn = 0.3 + 2.0 * np.pi * np.arange(sides) / sides
    plan = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    points = np.concatenate(
        [np.column_stack([0.5 + r * plan, np.full(sides, z)]) for r, z in zip(radius, height, strict=True)]
    )
    ring, i = np.divmod(np.arange(sides * (rings - 1)), sides)
    a, b = ring * sides + i, ring * sides + (i + 1) % sides
    walls = [np.column_stack([a, b, b + sides]), np.column_stack([a, b + sides, a + sides])]
    fan = np.array([[0, k, k + 1] for k in range(1, sides - 1)])
    return points, np.concatenate([*walls, fan[:, ::-1], fan + sides * (rings - 1)]).astype(np.int64)
