"""Resolve a job: find every offer that it names and check its parameters, once and before any work begins."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from amprep.cells import cell_offer, read_cell
from amprep.errors import InputError, JobError, MeshError, PluginError
from amprep.hookspecs import CellEmitter, Packer, SupportRouter, VolumeMaker
from amprep.host import Chosen, Host, Listed, choose
from amprep.job import Job, PackingSettings, apply_sets, as_names, job_from_inputs, override
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
    volumes
        Volume makers for parts that choose none, in the order in which they work.
    rule_cells
        The lattice cell of each ``[[rule]]`` entry.
    """

    job: Job
    host: Host
    volumes: tuple[Chosen[VolumeMaker], ...]
    packer: Chosen[Packer]
    router: Chosen[SupportRouter]
    cell: ChosenCell
    rule_cells: tuple[ChosenCell, ...] = ()

    def for_rule(self, number: int) -> "ResolvedJob":
        """Return the job with the settings of a ``[[rule]]`` entry, numbered from 1; 0 is the job itself."""
        if number == 0:
            return self
        return replace(self, job=self.job.for_rule(number), cell=self.rule_cells[number - 1])

    def read(self, path: Path) -> list[Part]:
        """Read one file with the reader that the job names for its suffix."""
        return read_by(self.host, path, self.job)

    def makers_for(self, part: Part) -> tuple[Chosen[VolumeMaker], ...]:
        """Return the volume makers for a part: those that it names, or else those of the job.

        Raises
        ------
        PluginError, JobError
            When the part names a volume maker that does not exist or cannot be in this place.
        """
        names = part.overrides.volumes or (None if part.boxes is None else ("boxes",))
        if names is None and self.job.packing.volumes is None and not part.is_solid:
            names = ("box",)  # a surface has no inside: of what packers choose, only its box is certain
        return self.volumes if names is None else choose_volumes(self.host, self.job, names)

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
    packer = choose_packer(host, packing)
    for entry in job.parts:
        if entry.volumes is not None:
            choose_volumes(host, job, as_names(entry.volumes))
    for name, table in packing.volume_params.items():
        choose(host, "volume", name, table)
    return ResolvedJob(
        job,
        host,
        packer=packer,
        router=choose(host, "router", supports.strategy, supports.params),
        cell=choose_cell(host, job),
        rule_cells=tuple(_rule_cell(host, job, number) for number, _ in enumerate(job.rules, 1)),
        volumes=choose_volumes(host, job, as_names(packing.volumes or packer.listed.offer.volumes)),
    )


def choose_packer(host: Host, packing: PackingSettings) -> Chosen[Packer]:
    """Return the packer of a job, with the parameters of its level of effort and those of the job.

    Raises
    ------
    PluginError
        When no packer has that name.
    JobError
        When a parameter is wrong, or the packer has no such level of effort.
    """
    listed: Listed[Packer] = host.choose("packer", packing.strategy)
    level = listed.offer.efforts.get(packing.effort)
    if level is None and packing.effort != "normal":
        known = ", ".join(["normal", *listed.offer.efforts])
        raise JobError(
            f"packing.effort: the packer {packing.strategy!r} knows {known} only, got {packing.effort!r}; set its "
            "budget in [packing.params] instead"
        )
    return Chosen.of(host, listed, {**(level or {}), **packing.params})


def choose_volumes(host: Host, job: Job, names: Sequence[str]) -> tuple[Chosen[VolumeMaker], ...]:
    """Return volume makers by name, with their parameters in the job.

    Raises
    ------
    PluginError
        When no volume maker has that name.
    JobError
        When a parameter is wrong, or a maker before the last makes something else than a solid.
    """
    makers = tuple(choose(host, "volume", name, job.packing.volume_params.get(name, {})) for name in names)
    for maker in makers[:-1]:
        if maker.listed.offer.makes != "solid":
            raise JobError(
                f"volumes: {maker.name!r} must be the last, since it makes {maker.listed.offer.makes!r}; only a "
                "volume maker that makes a solid can be followed by another"
            )
    return makers


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


def _rule_cell(host: Host, job: Job, number: int) -> ChosenCell:
    """Return the cell of a ``[[rule]]`` entry; messages about it name the entry."""
    try:
        return choose_cell(host, job.for_rule(number))
    except (PluginError, InputError, JobError) as error:
        raise type(error)(f"{job.source}: [[rule]] {number}: {error}") from error


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
        return _one_mesh(host, file, job)

    found = read_cell(path, read)
    return Listed("cell", cell_offer(found.name, found.summary, found.cell), str(path))


def read_by(host: Host, path: Path, job: Job) -> list[Part]:
    """Read one file as the ``[reading]`` section of a job says; see `amprep.host.Host.read`."""
    return host.read(path, job.reading.readers, job.reading.params, job.reading.shared)


def _one_mesh(host: Host, path: Path, job: Job) -> Mesh:
    """Return the one mesh in a file.

    Raises
    ------
    InputError
        When the file cannot be read or holds several meshes.
    """
    parts = read_by(host, path, job)
    if len(parts) != 1:
        raise MeshError(f"{path}: expected one mesh, the cell, got {len(parts)}")
    return parts[0].mesh
