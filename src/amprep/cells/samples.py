"""Sample requests on which a cell is measured and checked: a column, and a block."""

from dataclasses import replace
from itertools import product

import numpy as np

from amprep.model import DIRECTIONS, CellRequest, Grid, Role, SupportEdges
from amprep.model.supports.rules import SectionRules

LAYERS = 6
"""Layers of a column and of a block: enough for cells that change every second or third layer."""


def single_column(pitch: float, step: float, direction: int) -> CellRequest:
    """Return a column of trunk edges of one direction.

    Parameters
    ----------
    pitch, step
        Width and height (mm) of a voxel.
    direction
        Index into `amprep.model.DIRECTIONS`.
    """
    dy, dx = DIRECTIONS[direction]
    plane = np.arange(2, LAYERS + 2)
    side = LAYERS + 4
    grid = Grid(np.zeros(3), pitch, step, (LAYERS + 2, 2 * side, 2 * side))
    return _request(grid, plane, side - dy * plane, side - dx * plane, direction, Role.TRUNK)


def column_for(pitch: float, step: float, rules: SectionRules) -> CellRequest:
    """Return an upright column for a cell as meshes, with the rules by which cells choose default sizes.

    Parameters
    ----------
    pitch, step
        Width and height (mm) of a voxel.
    rules
        The least wall and the leg ratio.
    """
    column = single_column(pitch, step, 0)
    return replace(column, beams=False, least_wall=rules.least_wall_mm, leg_ratio=rules.leg_ratio)


def block(
    pitch: float, step: float, *, width: int = 3, layers: int = LAYERS, direction: int = 0
) -> CellRequest:
    """Return a block of edges of one direction: foot edges in the lowest layer, trunk edges above.

    Parameters
    ----------
    pitch, step
        Width and height (mm) of a voxel.
    width, layers
        Edges along x and y, and layers.
    direction
        Index into `amprep.model.DIRECTIONS`.
    """
    dy, dx = DIRECTIONS[direction]
    plane, y, x = np.array(list(product(range(1, layers + 1), range(width), range(width)))).T
    start = layers + 1
    grid = Grid(np.zeros(3), pitch, step, (layers + 1, width + 2 * start, width + 2 * start))
    role = np.where(plane == 1, Role.FOOT, Role.TRUNK)
    return _request(grid, plane, start + y - dy * plane, start + x - dx * plane, direction, role)


def _request(
    grid: Grid, plane: np.ndarray, y: np.ndarray, x: np.ndarray, direction: int, role: np.ndarray | int
) -> CellRequest:
    one = np.ones_like(plane)
    edges = SupportEdges(plane, y, x, one * direction, flow=one, capacity=one, group=0 * one)
    return CellRequest(grid, edges, one * role)
