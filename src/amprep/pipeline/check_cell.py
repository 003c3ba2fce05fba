"""Judges a lattice cell by itself, as `amprep cells check` shows it: emitted on a block, and on oblique columns."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from amprep.cells.samples import block
from amprep.checks.cells.ports import check_ports
from amprep.checks.cells.printability import (
    Limits,
    Measures,
    check_measures,
    check_overhangs,
    check_struts,
    measure,
)
from amprep.checks.cells.templates import check_cells
from amprep.checks.violation import Violation
from amprep.errors import JobError
from amprep.hookspecs import CellEmitter
from amprep.host import Host, Listed
from amprep.model import (
    DIRECTIONS,
    CellRequest,
    Cells,
    DeclaredCell,
    GraphCell,
    Stop,
    silent,
)

STEPS = 24
"""Voxels along each side of a cell when it is measured."""


@dataclass(frozen=True, eq=False)
class CellReport:
    """What `amprep cells check` found.

    Attributes
    ----------
    kinds
        Of its shapes: ``graph``, ``mesh``, ``implicit``; ``code`` for a cell without declaration.
    templates, triangles
        How many different templates the sample took, and the most triangles one of them has.
    limits, measures
        What was asked, and what was measured on a block.
    violations
        Broken promises; the subject says where.
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
    limits: Limits
    measures: Measures
    violations: tuple[Violation, ...]


def check_cell(
    host: Host,
    listed: Listed[CellEmitter],
    table: dict[str, Any],
    *,
    pitch: float = 2.0,
    strut_angle_deg: float = 45.0,
    limits: Limits | None = None,
    steps: int = STEPS,
) -> CellReport:
    """Judge one cell on a grid.

    Parameters
    ----------
    table
        Parameters of the cell, as in a job.
    limits
        Left out: what the cell itself promises, or else the usual.
    steps
        Voxels along each side of a cell when it is measured.

    Raises
    ------
    PluginError, JobError
        When the cell cannot be emitted in this grid.
    """
    _require_grid(pitch, strut_angle_deg)
    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    params = host.params(listed, table)
    declared = declared_cell(host, listed, table, pitch=pitch, strut_angle_deg=strut_angle_deg)
    limits = limits or _promised(declared)
    requests = {"upright edges": block(pitch, step)} | {
        f"oblique edges to {_WAYS[direction]}": block(pitch, step, width=1, direction=direction)
        for direction in range(1, len(DIRECTIONS))
    }
    found: list[Violation] = []
    answers = {}
    for where, request in requests.items():
        cells = host.call(listed, request, params=params, stop=Stop(), progress=silent)
        answers[where] = cells
        broken = check_cells(request, cells)
        found += broken
        if not broken:
            found += [*check_ports(request, cells), *_steepness(declared, request, cells, limits, where)]
    first = answers["upright edges"]
    measures = Measures(0.0, None, None, 0.0)
    if not found or all(violation.promise not in _UNSOUND for violation in found):
        measures = measure(requests["upright edges"], first, steps)
        found += check_measures(measures, limits, max(pitch, step) / steps)
    templates = [template for cells in answers.values() for template in cells.templates]
    return CellReport(
        listed.offer.name,
        listed.origin,
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


_WAYS = ("", "+x", "-x", "+y", "-y")
_UNSOUND = ("cell records", "unit cube", "closed")


def declared_cell(
    host: Host,
    listed: Listed[CellEmitter],
    table: dict[str, Any] | None = None,
    *,
    pitch: float = 2.0,
    strut_angle_deg: float = 45.0,
) -> DeclaredCell | None:
    """Return how a cell is declared in a grid, or None for one that is code alone.

    Raises
    ------
    PluginError, JobError
        When the declaration fails.
    """
    if listed.offer.declare is None:
        return None
    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    return host.declared(listed, pitch, step, host.params(listed, table or {}))


def limits_of(
    host: Host,
    listed: Listed[CellEmitter],
    table: dict[str, Any],
    *,
    pitch: float,
    strut_angle_deg: float,
    angle_deg: float | None = None,
    feature: float | None = None,
    hole: float | None = None,
) -> Limits:
    """Return the limits given, for the rest what the cell promises, for the rest the usual ones."""
    _require_grid(pitch, strut_angle_deg)
    declared = declared_cell(host, listed, table, pitch=pitch, strut_angle_deg=strut_angle_deg)
    given = {"angle_deg": angle_deg, "feature": feature, "hole": hole}
    for name, value in given.items():
        if value is not None and not 0.0 <= value < 1e6:
            raise JobError(f"{name} is a number from 0 on, got {value:g}")
    return _promised(declared)._replace(**{name: value for name, value in given.items() if value is not None})


def _require_grid(pitch: float, strut_angle_deg: float) -> None:
    if not (0.05 <= pitch <= 100.0 and 10.0 <= strut_angle_deg <= 80.0):
        raise JobError(
            f"a pitch of 0.05 to 100 mm and a strut angle of 10 to 80 degrees are possible, "
            f"got {pitch:g} and {strut_angle_deg:g}"
        )


def _promised(declared: DeclaredCell | None) -> Limits:
    """Return the limits that a cell promises to keep, the usual ones where it says nothing."""
    usual = Limits()
    if declared is None:
        return usual
    angle, feature = declared.least_angle_deg, declared.smallest_feature
    return Limits(
        usual.angle_deg if angle is None else angle, usual.feature if feature is None else feature, usual.hole
    )


def _steepness(
    declared: DeclaredCell | None, request: CellRequest, cells: Cells, limits: Limits, where: str
) -> list[Violation]:
    """Judge graphs strut by strut, everything else by its faces."""
    linear = request.matrices[0, :, :3]
    if declared is not None and declared.kinds == ("graph",):
        from amprep.cells.emission import fit

        shapes = [declared.variants[fitted.variant].shape for fitted in fit(declared, request)]
        graphs = {id(shape): shape for shape in shapes if isinstance(shape, GraphCell)}
        return [found for graph in graphs.values() for found in check_struts(graph, linear, limits, where)]
    used = [cells.templates[index] for index in np.unique(cells.template).tolist()]
    return [found for template in used for found in check_overhangs(template, linear, limits, where)]
