"""Check the answer of a cell emitter."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from amprep.errors import PluginError
from amprep.model import Beams, CellRequest, Cells, ExtraMesh, Mesh, Template

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
    fault = fault_of_cells(request, cells)
    if fault:
        raise PluginError(f"the lattice cell returned {fault}")
    return cells


def fault_of_cells(request: CellRequest, cells: Cells) -> str:
    """Return what is wrong with the form of an answer, as the object of "returned"; empty if nothing is."""
    return next(_faults(request, cells), "")


def _faults(request: CellRequest, cells: Any) -> Iterator[str]:
    count = len(cells.template)
    if cells.template.ndim != 1 or cells.edge.ndim != 1 or not len(cells.edge) == len(cells.matrix) == count:
        yield "arrays template, edge and matrix of different lengths"
    yield from _outside("template", cells.template, len(cells.templates))
    yield from _outside("edge", cells.edge, len(request.edges))
    if not np.isfinite(cells.matrix).all():
        yield "coordinates that are not finite"
    for kind, shapes in ((Template, cells.templates), (ExtraMesh, cells.extra)):
        if not isinstance(shapes, tuple) or not all(isinstance(each, kind) for each in shapes):
            yield f"something else than a tuple of {kind.__name__} records"
        yield from (fault for each in shapes for fault in _faults_of_mesh(each.mesh))
    yield from _outside("group", np.array([extra.group for extra in cells.extra]), _groups(request))
    if not isinstance(cells.hole, int | float) or not 0.0 <= cells.hole < np.inf:
        yield "a hole that is not a finite number from 0"
    if cells.beams is not None:
        yield from _faults_of_beams(request, cells.beams)


def _faults_of_mesh(mesh: Any) -> Iterator[str]:
    if not isinstance(mesh, Mesh):
        yield f"{type(mesh).__name__} as a mesh, expected amprep.model.Mesh"
        return
    yield from _outside("vertex", mesh.triangles.reshape(-1), len(mesh.vertices))
    if not np.isfinite(mesh.vertices).all():
        yield "coordinates that are not finite"


def _faults_of_beams(request: CellRequest, beams: Any) -> Iterator[str]:
    if not isinstance(beams, Beams):
        yield f"beams of type {type(beams).__name__}, expected amprep.model.Beams"
        return
    count = len(beams.struts)
    if count and request.beams is False:
        yield "beams where request.beams is False; return templates"
    struts, group = np.asarray(beams.struts), np.asarray(beams.group)
    nodes, radii = np.asarray(beams.nodes), np.asarray(beams.radii)
    if count and not (struts.shape == radii.shape == (count, 2) and group.shape == (count,)):
        yield "beams whose struts, radii and groups do not match"
    if nodes.size and nodes.shape != (len(nodes), 3):
        yield "beams whose nodes have not three coordinates each"
    yield from _outside("strut", struts.reshape(-1), len(nodes))
    yield from _outside("group", group.reshape(-1), _groups(request))
    if not np.isfinite(nodes).all() or not (np.isfinite(radii) & (radii > 0)).all():
        yield "beams with nodes that are not finite or radii not above 0"


def _groups(request: CellRequest) -> int:
    return int(request.edges.group.max(initial=-1)) + 1


def _outside(name: str, index: np.ndarray, count: int) -> Iterator[str]:
    if not len(index):
        return
    if index.dtype.kind not in "iu":
        yield f"a {name} index that is not a whole number"
    elif not (index.min() >= 0 and index.max() < count):
        yield f"a {name} index outside 0 to {count - 1}"
