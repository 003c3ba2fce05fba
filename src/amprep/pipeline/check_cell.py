"""Check a lattice cell by itself on sample requests, as `amprep cells check` does."""

from dataclasses import dataclass

import numpy as np

from amprep.cells.emission import fit
from amprep.cells.samples import block
from amprep.checks.cells.ports import check_ports
from amprep.checks.cells.printability import (
    CellMeasures,
    PrintLimits,
    check_measures,
    check_overhangs,
    check_struts,
    measure,
)
from amprep.checks.cells.templates import check_cells
from amprep.checks.violation import Violation
from amprep.errors import JobError
from amprep.model import DIRECTIONS, CellRequest, Cells, DeclaredCell, GraphCell
from amprep.pipeline.resolve import ChosenCell

STEPS = 24
"""Voxels along each side of a cell on which it is measured."""

_UPRIGHT = "upright edges"
_HEADINGS = ("", "+x", "-x", "+y", "-y")
_UNSOUND = ("cell records", "unit cube", "closed")
"""Promises without which a cell cannot be measured."""


@dataclass(frozen=True, eq=False)
class CellReport:
    """Result of `check_cell`.

    Attributes
    ----------
    kinds
        Kinds of its shapes: ``graph``, ``mesh``, ``implicit``; ``code`` for a cell without a declaration.
    templates, triangles
        Number of templates over all samples, and the largest number of triangles in a template.
    limits, measures
        Limits that were applied, and the values measured on a block.
    violations
        Broken promises; the subject names the sample.
    """

    name: str
    origin: str
    kinds: tuple[str, ...]
    author: str
    licence: str
    pitch: float
    step: float
    templates: int
    triangles: int
    limits: PrintLimits
    measures: CellMeasures
    violations: tuple[Violation, ...]


def check_cell(
    cell: ChosenCell,
    *,
    pitch: float = 2.0,
    strut_angle_deg: float = 45.0,
    angle_deg: float | None = None,
    feature: float | None = None,
    hole: float | None = None,
    steps: int = STEPS,
) -> CellReport:
    """Check one cell in a grid: on a block of upright edges, and on a column of oblique edges in each direction.

    Parameters
    ----------
    pitch, strut_angle_deg
        Pitch of the grid in mm, and steepness of its oblique edges.
    angle_deg, feature, hole
        Limits as in `PrintLimits`; None takes the limit that the cell promises, or else the usual limit.
    steps
        Voxels along each side of a cell on which it is measured.

    Raises
    ------
    PluginError, JobError
        When the cell cannot be emitted in this grid, or a limit is negative.
    """
    if not (0.05 <= pitch <= 100.0 and 10.0 <= strut_angle_deg <= 80.0):
        raise JobError(
            "the pitch must be between 0.05 and 100 mm and the strut angle between 10 and 80 degrees, "
            f"got {pitch:g} and {strut_angle_deg:g}"
        )
    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    declared = cell.declared(pitch, step)
    limits = _limits(declared, angle_deg=angle_deg, feature=feature, hole=hole)
    requests = _samples(pitch, step)
    answers = {where: cell.emit(request) for where, request in requests.items()}
    found = [
        violation
        for where, request in requests.items()
        for violation in _judge(declared, request, answers[where], limits, where)
    ]
    measures = CellMeasures(0.0, None, None, 0.0)
    if all(violation.promise not in _UNSOUND for violation in found):
        measures = measure(requests[_UPRIGHT], answers[_UPRIGHT], steps)
        found += check_measures(measures, limits, max(pitch, step) / steps)
    templates = [template for cells in answers.values() for template in cells.templates]
    return CellReport(
        cell.name,
        cell.listed.origin,
        declared.kinds if declared else ("code",),
        declared.author if declared else "",
        declared.licence if declared else "",
        pitch,
        step,
        len(templates),
        max((len(template.mesh.triangles) for template in templates), default=0),
        limits,
        measures,
        tuple(dict.fromkeys(found)),
    )


def _limits(declared: DeclaredCell | None, **given: float | None) -> PrintLimits:
    """Return each limit that is given, else the limit that the cell promises, else the usual limit."""
    for name, value in given.items():
        if value is not None and not 0.0 <= value < 1e6:
            raise JobError(f"{name} must be at least 0 and below 1000000, got {value:g}")
    promised: dict[str, float | None] = {}
    if declared is not None:
        promised = {"angle_deg": declared.least_angle_deg, "feature": declared.smallest_feature}
    return PrintLimits(
        **{name: value for values in (promised, given) for name, value in values.items() if value is not None}
    )


def _samples(pitch: float, step: float) -> dict[str, CellRequest]:
    """Return the sample requests by name."""
    return {_UPRIGHT: block(pitch, step)} | {
        f"oblique edges to {_HEADINGS[direction]}": block(pitch, step, width=1, direction=direction)
        for direction in range(1, len(DIRECTIONS))
    }


def _judge(
    declared: DeclaredCell | None, request: CellRequest, cells: Cells, limits: PrintLimits, where: str
) -> list[Violation]:
    """Judge the records and templates of an answer and, if they are sound, its ports and its steepness."""
    found = check_cells(request, cells)
    return found or [
        *check_ports(request, cells),
        *_check_steepness(declared, request, cells, limits, where),
    ]


def _check_steepness(
    declared: DeclaredCell | None, request: CellRequest, cells: Cells, limits: PrintLimits, where: str
) -> list[Violation]:
    """Judge the struts of a graph one by one, and other cells by their faces."""
    linear = request.matrices[0, :, :3]
    if declared is not None and declared.kinds == ("graph",):
        shapes = [declared.variants[fitted.variant].shape for fitted in fit(declared, request)]
        graphs = {id(shape): shape for shape in shapes if isinstance(shape, GraphCell)}
        return [found for graph in graphs.values() for found in check_struts(graph, linear, limits, where)]
    used = [cells.templates[index] for index in np.unique(cells.template).tolist()]
    return [found for template in used for found in check_overhangs(template, linear, limits, where)]
