"""Resolve a job: find every offer that it names and check its parameters, once and before any work begins."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from amprep.cells import cell_offer, read_cell
from amprep.errors import InputError, MeshError
from amprep.hookspecs import CellEmitter, Packer, SupportRouter, VolumeMaker
from amprep.host import Chosen, Host, Listed, choose
from amprep.job import Job, apply_sets, job_from_inputs, override
from amprep.model import CellRequest, Cells, DeclaredCell, Mesh, Part, Progress, Stop, silent


class ChosenCell(Chosen[CellEmitter]):
    """A lattice cell and its checked parameters, ready to be called."""

    def emit(self, request: CellRequest, *, stop: Stop | None = None, progress: Progress = silent) -> Cells:
        """Replace the edges of the request by geometry."""
        cells: Cells = self.call(request, stop=stop or Stop(), progress=progress)
        return cells

    def material(self, pitch: float, step: float) -> tuple[float, float]:
        """Estimate the volume (mm3) of a vertical and of an oblique edge in a grid of this pitch and step (mm)."""
        return self.host.material(self.listed, pitch, step, self.params)

    def declared(self, pitch: float, step: float) -> DeclaredCell | None:
        """Return the declaration of the cell for a grid of this pitch and step (mm); None if it is code alone."""
        if self.listed.offer.declare is None:
            return None
        return self.host.declared(self.listed, pitch, step, self.params)


@dataclass(frozen=True, eq=False)
class ResolvedJob:
    """A job with the offers that it names, each with its checked parameters.

    Attributes
    ----------
    volume, given_boxes
        Makers of bounding volumes: for parts without and with boxes in the job file.
    """

    job: Job
    host: Host
    volume: Chosen[VolumeMaker]
    given_boxes: Chosen[VolumeMaker]
    packer: Chosen[Packer]
    router: Chosen[SupportRouter]
    cell: ChosenCell

    def read(self, path: Path) -> list[Part]:
        """Read one file with the reader that the job names for its suffix."""
        return self.host.read(path, self.job.reading.readers, self.job.reading.params)

    def changed(self, changes: Mapping[str, Any]) -> "ResolvedJob":
        """Return the job with other settings, by dotted keys as in `amprep.job.override`.

        Raises
        ------
        JobError, PluginError
            As `resolve` does.
        """
        job = override(self.job, changes)
        return self if job is self.job else resolve(job, self.host)


def resolve(job: Job, host: Host) -> ResolvedJob:
    """Find every offer that the job names and check its parameters.

    Raises
    ------
    PluginError
        When the job names an offer that does not exist.
    JobError
        When a parameter is unknown or has a wrong value.
    InputError
        When the file that is to declare the lattice cell declares none.
    """
    packing, supports = job.packing, job.supports
    return ResolvedJob(
        job,
        host,
        packer=choose(host, "packer", packing.strategy, packing.params),
        router=choose(host, "router", supports.strategy, supports.params),
        cell=choose_cell(host, job),
        volume=choose(host, "volume", packing.volumes, packing.volume_params),
        given_boxes=choose(host, "volume", "boxes", {}),
    )


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
    parts = host.read(path, readers, params)
    if len(parts) != 1:
        raise MeshError(f"{path}: expected one mesh, the cell, got {len(parts)}")
    return parts[0].mesh
