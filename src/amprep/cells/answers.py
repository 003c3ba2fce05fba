"""Check the answer of a cell emitter."""

from collections.abc import Callable

import numpy as np

from amprep.errors import PluginError
from amprep.model import Beams, CellRequest, Cells

Emit = Callable[[CellRequest], Cells]
"""Calls a lattice cell."""


def checked(request: CellRequest, cells: object) -> Cells:
    """Return the answer of an emitter if the host can rely on it.

    Parameters
    ----------
    request
        Request that was answered.
    cells
        Answer.

    Raises
    ------
    PluginError
        If the answer has another type, indices out of range, values that are not finite, or beams that were refused.
    """
    if not isinstance(cells, Cells):
        raise PluginError(f"the lattice cell returned {type(cells).__name__}, expected amprep.model.Cells")
    count = len(cells.template)
    if not len(cells.edge) == len(cells.matrix) == count:
        raise PluginError("the lattice cell returned arrays template, edge and matrix of different lengths")
    _require_range("template", cells.template, len(cells.templates))
    _require_range("edge", cells.edge, len(request.edges))
    _require_range(
        "group",
        np.array([extra.group for extra in cells.extra]),
        int(request.edges.group.max(initial=-1)) + 1,
    )
    meshes = [template.mesh for template in cells.templates] + [extra.mesh for extra in cells.extra]
    finite = np.isfinite(cells.matrix).all() and all(np.isfinite(mesh.vertices).all() for mesh in meshes)
    if not finite:
        raise PluginError("the lattice cell returned coordinates that are not finite")
    if cells.beams is not None and len(cells.beams.struts):
        _require_beams(request, cells.beams)
    return cells


def _require_beams(request: CellRequest, beams: Beams) -> None:
    if request.beams is False:
        raise PluginError("the lattice cell returned beams where request.beams is False; return templates")
    count = len(beams.struts)
    if (
        np.shape(beams.struts) != (count, 2)
        or np.shape(beams.radii) != (count, 2)
        or len(beams.group) != count
    ):
        raise PluginError("the lattice cell returned beams whose struts, radii and groups do not match")
    _require_range("strut", np.asarray(beams.struts), len(beams.nodes))
    _require_range("group", np.asarray(beams.group), int(request.edges.group.max(initial=-1)) + 1)
    if not np.isfinite(beams.nodes).all() or not (np.isfinite(beams.radii) & (beams.radii > 0)).all():
        raise PluginError(
            "the lattice cell returned beams with nodes that are not finite or radii not above 0"
        )


def _require_range(name: str, index: np.ndarray, count: int) -> None:
    if len(index) and not (index.min() >= 0 and index.max() < count):
        raise PluginError(f"the lattice cell returned a {name} index outside 0 to {count - 1}")
