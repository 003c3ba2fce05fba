"""Turn a declared cell into an offer, which a plugin yields and a job chooses by name."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from amprep.hookspecs import CellEmitter, NoParams
from amprep.model import CellRequest, Cells, DeclaredCell, GraphCell, Progress, Shape, Stop
from amprep.validation import require_bounds

Declare = Callable[[float, float, Any], "Shape | DeclaredCell"]
"""Makes the cell for a grid from its pitch and step (mm) and the checked parameters."""

FitParams = Callable[[Any, CellRequest], Any]
"""Returns the checked parameters with the sizes that the user left open chosen by the limits of a request."""


@dataclass(frozen=True)
class GraphParams:
    """Parameters of a cell that is declared as a graph without a parameter class.

    Attributes
    ----------
    solid
        Whether struts become solids instead of beams.
    radius_factor
        Factor on all radii, 0.1 to 10.
    """

    solid: bool = True
    radius_factor: float = 1.0

    def __post_init__(self) -> None:
        require_bounds(self, "radius_factor", at_least=0.1, at_most=10)


def cell_offer(
    name: str,
    summary: str,
    cell: "Shape | DeclaredCell | Declare",
    *,
    params: type | None = None,
    fit_params: FitParams | None = None,
) -> CellEmitter:
    """Return the offer of a declared cell.

    Parameters
    ----------
    name, summary
        Name by which a job chooses the cell, and a sentence for lists.
    cell
        A shape, a cell with variants, or a function that makes one from pitch, step (mm) and parameters.
    params
        Frozen dataclass of the parameters; a field ``solid`` that is False turns struts into beams. The default is
        `GraphParams` for a cell of graphs, and no parameters for other cells.
    fit_params
        Chooses sizes that the user left open by the least wall and the leg ratio of the request; None for sizes that
        do not depend on them.
    """
    declare, default_params = _declaration(cell)

    def emit(request: CellRequest, *, params: Any, stop: Stop, progress: Progress) -> Cells:  # noqa: ARG001
        from amprep.cells.emission import emit_declared

        chosen = params if fit_params is None else fit_params(params, request)
        made = declare(request.grid.pitch, request.grid.step, chosen)
        return emit_declared(made, request, solid=getattr(params, "solid", True))

    def material(pitch: float, step: float, params: Any) -> tuple[float, float]:
        return estimate(declare(pitch, step, params), pitch, step)

    return CellEmitter(
        name, summary, run=emit, params=params or default_params, material=material, declare=declare
    )


def _declaration(
    cell: "Shape | DeclaredCell | Declare",
) -> tuple[Callable[[float, float, Any], DeclaredCell], type]:
    """Return the function that makes the cell, and its default parameter class."""
    if callable(cell):
        return lambda pitch, step, chosen: DeclaredCell.of(cell(pitch, step, chosen)), NoParams
    fixed = DeclaredCell.of(cell)
    is_graph = fixed.kinds == ("graph",)
    return lambda _pitch, _step, chosen: _scaled(fixed, chosen), GraphParams if is_graph else NoParams


def estimate(cell: DeclaredCell, pitch: float, step: float) -> tuple[float, float]:
    """Return the volume (mm3) of a vertical and of an oblique edge, averaged over the layers of a column.

    Parameters
    ----------
    cell
        Cell to measure.
    pitch, step
        Width and height (mm) of a voxel.
    """
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
    """Return the cell with its radii scaled by the parameter ``radius_factor``, if there is one."""
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
