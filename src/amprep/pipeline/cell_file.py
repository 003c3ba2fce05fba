"""Chooses the job's lattice cell: by name, or a shape that an engineer drew, from a mesh file."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from amprep.checks.templates import check_template
from amprep.errors import MeshError
from amprep.hookspecs import CellEmitter, EmitCells, NoParams
from amprep.host import Host, Listed
from amprep.job import Job
from amprep.model import CellRequest, Cells, Mesh, Report, Stop, Template


def choose_cell(host: Host, job: Job) -> Listed[CellEmitter]:
    """Return the lattice cell that the job names, or one made of the mesh file it names.

    Raises
    ------
    PluginError
        When no cell has that name.
    InputError
        When the file is not one closed mesh in the unit cube.
    """
    if job.cells.file is None:
        return host.choose("cell", job.cells.strategy)
    template = read_template(host, job, job.cells.file)
    emitter = CellEmitter(
        template.name, "A shape from a file.", run=_repeated(template), material=_material(template.mesh)
    )
    return Listed("cell", emitter, str(job.cells.file))


def read_template(host: Host, job: Job, path: Path) -> Template:
    """Return the one shape in a mesh file as a template.

    Raises
    ------
    InputError
        When the file is not one closed mesh in the unit cube.
    """
    reader = host.reader_for(path, job.reading.readers)
    params = host.params(reader, job.reading.params.get(reader.offer.name, {}))
    parts = host.call(reader, path, params=params)
    if len(parts) != 1:
        raise MeshError(f"{path}: expected one mesh, the cell, got {len(parts)}")
    template = Template(path.stem, parts[0].mesh)
    for violation in check_template(template):
        raise MeshError(f"{path}: a cell is a closed mesh in the unit cube, z up; {violation.message}")
    return template


def _repeated(template: Template) -> EmitCells:
    def emit(request: CellRequest, *, params: NoParams, stop: Stop, report: Report) -> Cells:  # noqa: ARG001
        count = len(request.plane)
        return Cells(
            (template,), np.zeros(count, np.int32), np.arange(count, dtype=np.int32), request.matrices
        )

    return emit


def _material(mesh: Mesh) -> Callable[[float, float, NoParams], tuple[float, float]]:
    def material(pitch: float, step: float, params: NoParams) -> tuple[float, float]:  # noqa: ARG001
        volume = mesh.signed_volume * pitch * pitch * step
        return volume, volume

    return material
