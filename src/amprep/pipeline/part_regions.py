"""Blockers and enforcers that a job names for its parts, read from mesh files."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from amprep.errors import JobError, MeshError
from amprep.geometry.solids import settle
from amprep.job import Job, PartSettings, names_part
from amprep.model import Mesh, Part, Region
from amprep.model.part import RegionKind

Read = Callable[[Path], list[Part]]


def with_region_files(parts: Sequence[Part], job: Job, read: Read) -> list[Part]:
    """Return the parts with the blockers and enforcers of every ``[[part]]`` entry that names them.

    A 3MF's meshes lie where its build items put them; coordinates are the part's.

    Raises
    ------
    JobError, InputError, MeshError
        When a file is not there, cannot be read, or holds anything but closed meshes.
    """
    result = list(parts)
    for entry in job.parts:
        regions = _regions(entry, job, read)
        for index, part in enumerate(parts):
            if regions and names_part(entry, part, job):
                result[index] = replace(result[index], regions=(*result[index].regions, *regions))
    return result


def _regions(entry: PartSettings, job: Job, read: Read) -> tuple[Region, ...]:
    kinds: tuple[tuple[RegionKind, tuple[str, ...]], ...] = (
        ("blocker", entry.blockers),
        ("enforcer", entry.enforcers),
    )
    return tuple(
        Region(kind, part.name, mesh=mesh)
        for kind, files in kinds
        for file in files
        for part in _read(file, job, read)
        for mesh in _closed(part, kind, file)
    )


def _read(file: str, job: Job, read: Read) -> list[Part]:
    path = (job.folder or Path()) / file
    if not path.is_file():
        raise JobError(f"{job.source}: [[part]]: blockers and enforcers are mesh files, no file at {path}")
    return read(path)


def _closed(part: Part, kind: RegionKind, file: str) -> list[Mesh]:
    """Return the part's solid once for each of its positions."""
    settled = settle(part.mesh.vertices, part.mesh.triangles)
    if settled.problem:
        raise MeshError(f"{file}: expected closed meshes for {kind}s, {part.name} is none: {settled.problem}")
    positions = np.zeros((1, 3)) if part.positions is None else part.positions
    return [Mesh(settled.vertices + position, settled.triangles) for position in positions]
