"""Draw a lattice cell: a block of upright edges, and beside it a column of oblique edges."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from amprep.cells.answers import Emit
from amprep.cells.samples import block
from amprep.geometry.cells.tiling import expand
from amprep.model import CellRequest, Cells, Mesh

_COLOUR = "#c58b45"
_LAYERS = 3


def draw_cell(emit: Emit, path: Path, *, pitch: float, strut_angle_deg: float) -> None:
    """Write a picture of a cell as a PNG file.

    Parameters
    ----------
    emit
        Calls the cell.
    path
        File to write.
    pitch, strut_angle_deg
        Pitch of the grid in mm, and steepness of its oblique edges.

    Raises
    ------
    PluginError, JobError
        When the cell cannot be emitted in this grid.
    InputError
        When the file cannot be written.
    """
    from amprep.report.picture import draw_mesh

    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    upright = _expanded(emit(block(pitch, step, width=3, layers=_LAYERS)))
    oblique = _expanded(emit(_lowest(block(pitch, step, width=1, direction=1))))
    (low, high), (corner, _) = upright.bounds, oblique.bounds
    shift = np.eye(4)
    shift[:3, 3] = [high[0] + pitch, low[1], low[2]] - corner
    beside = oblique.moved(shift)
    both = Mesh(
        np.vstack([upright.vertices, beside.vertices]),
        np.vstack([upright.triangles, beside.triangles + len(upright.vertices)]),
    )
    draw_mesh(both, path, size=(800, 600), colour=_COLOUR)


def _lowest(request: CellRequest) -> CellRequest:
    """Return the request for the lowest layers alone."""
    chosen = request.edges.plane < request.edges.plane.min() + _LAYERS
    return replace(request, edges=request.edges[chosen], role=request.role[chosen])


def _expanded(cells: Cells) -> Mesh:
    templates = [each.mesh.arrays for each in cells.templates]
    points, triangles, _ = expand(templates, cells.template.astype(np.int64), cells.matrix)
    return Mesh(points, triangles.astype(np.int32))
