"""Turns a declared cell into an offer that a plugin yields and a job picks by name."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from amprep.hookspecs import CellEmitter, NoParams
from amprep.model import CellRequest, Cells, DeclaredCell, GraphCell, Progress, Shape, Stop

Declare = Callable[[float, float, Any], "Shape | DeclaredCell"]
"""Makes the cell for a grid, given pitch and step in mm and the checked parameters."""


@dataclass(frozen=True)
class GraphParams:
    """Parameters of every cell that is declared as a graph and has none of its own.

    Attributes
    ----------
    solid
        Struts as solids; false: as beams.
    radius_factor
        All struts are that much thicker, 0.1 to 10.
    """

    solid: bool = True
    radius_factor: float = 1.0

    def __post_init__(self) -> None:
        if not 0.1 <= self.radius_factor <= 10.0:
            raise ValueError(f"radius_factor is between 0.1 and 10, got {self.radius_factor}")


def cell_offer(
    name: str, summary: str, cell: "Shape | DeclaredCell | Declare", *, params: type | None = None
) -> CellEmitter:
    """Return the offer of a declared cell.

    Parameters
    ----------
    cell
        A shape, a cell with variants, or a function of pitch, step (mm) and params that makes one.
    params
        Frozen dataclass as for every offer; a field ``solid`` that is False turns struts into beams. Left out, a
        cell made of graphs gets `GraphParams`, another one none.
    """
    declare, usual = _declaration(cell)
    wanted = params or usual

    def emit(request: CellRequest, *, params: Any, stop: Stop, progress: Progress) -> Cells:  # noqa: ARG001
        from amprep.cells.emission import emit_declared

        made = declare(request.frame.pitch, request.frame.step, params)
        return emit_declared(made, request, solid=getattr(params, "solid", True))

    def material(pitch: float, step: float, params: Any) -> tuple[float, float]:
        return estimate(declare(pitch, step, params), pitch, step)

    return CellEmitter(name, summary, run=emit, params=wanted, material=material, declare=declare)


def _declaration(
    cell: "Shape | DeclaredCell | Declare",
) -> tuple[Callable[[float, float, Any], DeclaredCell], type]:
    """Return how the cell is made, and the params class it has when it brings none."""
    if callable(cell):
        return lambda pitch, step, chosen: DeclaredCell.of(cell(pitch, step, chosen)), NoParams
    fixed = DeclaredCell.of(cell)
    is_graph = fixed.kinds == ("graph",)
    return lambda _pitch, _step, chosen: _scaled(fixed, chosen), GraphParams if is_graph else NoParams


def estimate(cell: DeclaredCell, pitch: float, step: float) -> tuple[float, float]:
    """Return the mm3 of a vertical and of an oblique edge, on average over the layers of the stack."""
    from amprep.cells.emission import emit_declared
    from amprep.cells.samples import single_column

    volumes = []
    for direction in (0, 1):
        request = single_column(pitch, step, direction)
        cells = emit_declared(cell, request)
        each = np.array([0.0 if each.surface else each.mesh.signed_volume for each in cells.templates])
        volumes.append(float(each[cells.template].sum()) / len(request.edges) * pitch * pitch * step)
    return volumes[0], volumes[1]


def _scaled(cell: DeclaredCell, params: Any) -> DeclaredCell:
    """Return the cell with the struts as thick as the parameters say."""
    factor = getattr(params, "radius_factor", 1.0)
    if factor == 1.0:
        return cell
    variants = [
        replace(variant, shape=replace(variant.shape, radius=variant.shape.radii * factor))
        if isinstance(variant.shape, GraphCell) and len(variant.shape.struts)
        else variant
        for variant in cell.variants
    ]
    return replace(cell, variants=tuple(variants))
