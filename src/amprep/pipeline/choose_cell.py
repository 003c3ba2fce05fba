"""Choose the job's lattice cell: by name, or from a file that declares one."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from amprep.cells import cell_offer, read_cell
from amprep.errors import InputError, MeshError
from amprep.hookspecs import CellEmitter
from amprep.host import Host, Listed
from amprep.job import Job, apply_sets, job_from_inputs
from amprep.model import CellRequest, Cells, DeclaredCell, Mesh, Progress, Stop, silent


@dataclass(frozen=True, eq=False)
class ChosenCell:
    """A lattice cell and its checked parameters, ready to be called.

    Attributes
    ----------
    listed
        The offer, and the plugin or file that it comes from.
    params
        Instance of the parameter class of the offer.
    """

    host: Host
    listed: Listed[CellEmitter]
    params: Any

    @classmethod
    def of(cls, host: Host, listed: Listed[CellEmitter], table: Mapping[str, Any]) -> "ChosenCell":
        """Check the parameters in `table` and return the cell with them.

        Raises
        ------
        JobError
            When a parameter is unknown or has a wrong value.
        """
        return cls(host, listed, host.params(listed, table))

    @property
    def name(self) -> str:
        """Name of the offer."""
        return self.listed.offer.name

    def emit(self, request: CellRequest, *, stop: Stop | None = None, progress: Progress = silent) -> Cells:
        """Replace the edges of the request by geometry."""
        return self.host.call(
            self.listed, request, params=self.params, stop=stop or Stop(), progress=progress
        )

    def material(self, pitch: float, step: float) -> tuple[float, float]:
        """Estimate the volume (mm3) of a vertical and of an oblique edge in a grid of this pitch and step (mm)."""
        return self.host.material(self.listed, pitch, step, self.params)

    def declared(self, pitch: float, step: float) -> DeclaredCell | None:
        """Return the declaration of the cell for a grid of this pitch and step (mm); None if it is code alone."""
        if self.listed.offer.declare is None:
            return None
        return self.host.declared(self.listed, pitch, step, self.params)


def choose_cell(host: Host, job: Job) -> ChosenCell:
    """Return the lattice cell that the job names, or the cell that its file declares.

    The file is read here. A run therefore calls this function once and passes the result on.

    Raises
    ------
    PluginError
        When no cell has that name.
    InputError
        When the file declares no cell.
    JobError
        When a parameter is unknown or has a wrong value.
    """
    return ChosenCell.of(host, _listed(host, job), job.cells.params)


def cell_named(host: Host, cell: str, sets: Sequence[str] = ()) -> ChosenCell:
    """Return the cell with a name or path.

    Parameters
    ----------
    cell
        Name of an offer, or path of a TOML or mesh file.
    sets
        Parameters of the cell, each as ``key=value``.

    Raises
    ------
    PluginError, InputError, JobError
        As `choose_cell` does for a job that names the cell.
    """
    job = job_from_inputs(["part.stl"])
    path = replace(job.cells, strategy=cell).file
    if path is not None and not path.is_file():
        raise InputError(f"{cell}: no such file; expected the name of a lattice cell, or a TOML or mesh file")
    wanted = [f"cells.strategy={json.dumps(cell)}", *(f"cells.params.{each}" for each in sets)]
    return choose_cell(host, apply_sets(job, wanted))


def _listed(host: Host, job: Job) -> Listed[CellEmitter]:
    path = job.cells.file
    if path is None:
        return host.choose("cell", job.cells.strategy)

    def read(file: Path) -> Mesh:
        return _one_mesh(host, file, job.reading.readers, job.reading.params)

    found = read_cell(path, read)
    return Listed("cell", cell_offer(found.name, found.summary, found.cell), str(path))


def _one_mesh(
    host: Host, path: Path, readers: Mapping[str, str], params: Mapping[str, Mapping[str, Any]]
) -> Mesh:
    """Return the one mesh in a file.

    Raises
    ------
    InputError
        When the file cannot be read or holds several meshes.
    """
    reader = host.reader_for(path, readers)
    parts = host.call(reader, path, params=host.params(reader, params.get(reader.offer.name, {})))
    if len(parts) != 1:
        raise MeshError(f"{path}: expected one mesh, the cell, got {len(parts)}")
    return parts[0].mesh
