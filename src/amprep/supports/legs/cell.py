"""State what planning needs to know of a lattice cell, and measure how wide a lone column of it is."""

from dataclasses import dataclass, replace

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.cells.answers import Emit
from amprep.cells.samples import single_column
from amprep.model import CellRequest, Cells
from amprep.model.supports.rules import SectionRules
from amprep.supports.legs.sections import directions

_NEAR = 0.05
"""Fraction of a cell's height up to which its points belong to its lower or upper square."""


@dataclass(frozen=True, eq=False)
class CellProperties:
    """What planning needs to know of the lattice cell that replaces the edges.

    Attributes
    ----------
    material
        Material of a vertical and of an oblique edge, mm3.
    extents
        Extents (mm) of one cell in the horizontal directions, see `measure_cell`; None for a cell that fills its
        square.
    """

    material: tuple[float, float] = (1.0, 1.0)
    extents: Floats | None = None

    def __post_init__(self) -> None:
        if self.extents is not None:
            object.__setattr__(self, "extents", frozen(self.extents, np.float64))

    def extents_in(self, pitch: float) -> Floats:
        """Return the extents (mm) of one cell in a grid of this pitch (mm)."""
        return square_cell(pitch) if self.extents is None else self.extents


def measure_cell(emit: Emit, pitch: float, step: float, rules: SectionRules) -> Floats:
    """Return the extents (mm) of one cell in the horizontal `directions`, where it is least wide.

    A column is emitted and measured at the planes of the grid. Cells that answer with finished meshes alone count as
    whole squares.

    Parameters
    ----------
    emit
        Calls the cell.
    pitch, step
        Width and height (mm) of a voxel.
    rules
        The least wall and the leg ratio, by which cells choose default sizes.
    """
    column = single_column(pitch, step, 0)
    request = replace(column, beams=False, least_wall=rules.least_wall_mm, leg_ratio=rules.leg_ratio)
    found = _extents(request, emit(request))
    return min(found, key=lambda extents: float(extents.min())) if found else square_cell(pitch)


def square_cell(side: float) -> Floats:
    """Return the extents of a cell that fills its square, in the horizontal `directions`."""
    return np.asarray(side * np.abs(directions()).sum(axis=1))


def _extents(request: CellRequest, cells: Cells) -> list[Floats]:
    """Return the extents of the instances of each edge at its lower and at its upper square."""
    found = []
    for edge in range(len(request.edges)):
        for side in (0.0, 1.0):
            points = [_points(cells, i, side) for i in np.flatnonzero(cells.edge == edge).tolist()]
            if any(len(each) for each in points):
                found.append(np.ptp(np.concatenate(points) @ directions().T, axis=0))
    return found


def _points(cells: Cells, instance: int, side: float) -> Floats:
    """Return the points ``(n, 2)`` of an instance near the lower (0) or upper (1) square of its edge."""
    vertices = cells.templates[cells.template[instance]].mesh.vertices
    near = vertices[np.abs(vertices[:, 2] - side) <= _NEAR]
    matrix = cells.matrix[instance]
    return np.asarray((near @ matrix[:, :3].T + matrix[:, 3])[:, :2])
