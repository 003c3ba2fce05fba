"""Chooses the job's lattice cell: by name, or from a file that declares one."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from amprep.cells import cell_offer, read_cell
from amprep.errors import InputError, MeshError
from amprep.hookspecs import CellEmitter
from amprep.host import Host, Listed
from amprep.job import Job, apply_sets, job_from_inputs
from amprep.model import Mesh


def choose_cell(host: Host, job: Job) -> Listed[CellEmitter]:
    """Return the lattice cell that the job names, or the one that the file it names declares.

    Raises
    ------
    PluginError
        When no cell has that name.
    InputError
        When the file declares no cell.
    """
    if job.cells.file is None:
        return host.choose("cell", job.cells.strategy)
    path = job.cells.file

    def read(file: Path) -> Mesh:
        return _one_mesh(host, file, job.reading.readers, job.reading.params)

    found = read_cell(path, read)
    return Listed("cell", cell_offer(found.name, found.summary, found.cell), str(path))


def cell_named(host: Host, cell: str, sets: Sequence[str] = ()) -> tuple[Listed[CellEmitter], dict[str, Any]]:
    """Return the cell of a name or path, and its parameters given as ``key=value``.

    Raises
    ------
    PluginError, InputError, JobError
        As for a job that names the cell.
    """
    job = job_from_inputs(["part.stl"])
    path = replace(job.cells, strategy=cell).file
    if path is not None and not path.is_file():
        raise InputError(f"{cell}: no such file; expected the name of a lattice cell, or a TOML or mesh file")
    wanted = [f"cells.strategy={json.dumps(cell)}", *(f"cells.params.{each}" for each in sets)]
    job = apply_sets(job, wanted)
    return choose_cell(host, job), dict(job.cells.params)


def _one_mesh(
    host: Host, path: Path, readers: Mapping[str, str], params: Mapping[str, Mapping[str, Any]]
) -> Mesh:
    """Return the one mesh in a file.

    Raises
    ------
    InputError
        When it cannot be read or holds several.
    """
    reader = host.reader_for(path, readers)
    parts = host.call(reader, path, params=host.params(reader, params.get(reader.offer.name, {})))
    if len(parts) != 1:
        raise MeshError(f"{path}: expected one mesh, the cell, got {len(parts)}")
    return parts[0].mesh
