"""Draws a lattice cell: a block of upright edges, and beside it a column that leads aside."""

from pathlib import Path
from typing import Any

import numpy as np

from amprep.cells.samples import block
from amprep.hookspecs import CellEmitter
from amprep.host import Host, Listed
from amprep.model import CellRequest, Cells, Mesh, Stop, silent

_COLOUR = "#c58b45"


def draw_cell(
    host: Host,
    listed: Listed[CellEmitter],
    table: dict[str, Any],
    path: Path,
    *,
    pitch: float,
    strut_angle_deg: float,
) -> None:
    """Write a PNG of a cell with the parameters of `table`, in a grid of this pitch and angle.

    Raises
    ------
    PluginError, JobError
        When the cell cannot be emitted in this grid.
    InputError
        When the file cannot be written.
    """
    from amprep.report.picture import draw_mesh

    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    params = host.params(listed, table)
    shown = []
    for request in (block(pitch, step, width=3, layers=3), block(pitch, step, width=1, direction=1)):
        lowest = request.plane <= request.plane.min() + 2
        chosen = _only(request, lowest)
        shown.append(_expanded(host.call(listed, chosen, params=params, stop=Stop(), progress=silent)))
    first, second = shown
    (low, high), (aside, _) = first.bounds, second.bounds
    shift = np.eye(4)
    shift[:3, 3] = [high[0] + pitch, low[1], low[2]] - aside
    moved = second.moved(shift)
    both = Mesh(
        np.vstack([first.vertices, moved.vertices]),
        np.vstack([first.triangles, moved.triangles + len(first.vertices)]),
    )
    draw_mesh(both, path, size=(800, 600), colour=_COLOUR)


def _only(request: CellRequest, chosen: np.ndarray) -> CellRequest:
    columns = ("plane", "y", "x", "direction", "role", "load", "group")
    return CellRequest(request.frame, *(getattr(request, name)[chosen] for name in columns))


def _expanded(cells: Cells) -> Mesh:
    from amprep.geometry.cells.tiling import expand

    templates = [(each.mesh.vertices, each.mesh.triangles.astype(np.int64)) for each in cells.templates]
    points, triangles, _ = expand(templates, cells.template.astype(np.int64), cells.matrix)
    return Mesh(points, triangles.astype(np.int32))
