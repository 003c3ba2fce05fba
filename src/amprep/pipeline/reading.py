"""Read the inputs of a job: expand folders, repair meshes, make names unique and apply the part settings."""

import os
import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from itertools import islice
from pathlib import Path
from typing import NoReturn

import numpy as np

from amprep.errors import AmprepError, InputError, JobError, MeshError
from amprep.geometry.meshes.repair import RepairedMesh, find_defect, repair_mesh
from amprep.job import Job, PartSettings, apply_part_settings, names_part
from amprep.model.control import Progress, silent
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance, Part, Region, RegionKind
from amprep.model.summary import Summarised
from amprep.pipeline.labelling.apply import labelled
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock
from amprep.pipeline.unit_question import with_unit_question
from amprep.sealing.seal import file_digest
from amprep.workers import share_out

_OF_A_RUN = re.compile(r"\.build-\d+\.")
"""In the names of files that amprep writes."""

_MOST_FILES = 10_000
"""Largest number of files in a folder and its subfolders."""

_REPAIR_WORK = 2.0
"""Work of repairing a mesh, by its triangles."""


def expand_inputs(
    inputs: Sequence[tuple[Path, int | None]], suffixes: Collection[str]
) -> list[tuple[Path, int | None]]:
    """Return the files to read with their counts, in order.

    A folder is replaced by its files with a known suffix and those of its subfolders, sorted by path. Hidden files and
    folders, links to folders, and build files of earlier runs are left out. The count of a folder applies to each of
    its files.

    Raises
    ------
    InputError
        When a path does not exist, or a folder has no file to read or too many.
    """
    return [(file, count) for path, count in inputs for file in _expand(path, suffixes)]


def read_all(
    files: Sequence[tuple[Path, int | None]],
    read: Callable[[Path], list[Part]],
    *,
    allow_surface: bool = False,
    progress: Progress = silent,
) -> list[Part]:
    """Read the files in order and repair their meshes; a count multiplies the quantity of each part of its file.

    Parameters
    ----------
    files
        Paths with their counts, as `expand_inputs` returns them.
    read
        Reads one file and returns its parts.
    allow_surface
        Whether meshes that are not solids are accepted as surfaces.
    progress
        Called before each file.

    Raises
    ------
    InputError, MeshError
        For the first file or part that cannot be read.
    """
    found, refused = list[Part](), None
    for done, (path, count) in enumerate(files):
        progress(done / len(files), path.name)
        try:
            read_parts, sha256 = read(path), file_digest(path)
        except AmprepError as error:
            refused = error  # a mesh before it that is unusable comes first
            break
        found += [
            replace(part, quantity=part.quantity * (count or 1), source_sha256=sha256) for part in read_parts
        ]
    parts = repair_parts(found, allow_surface=allow_surface)
    if refused is not None:
        raise refused
    progress(1.0, f"{len(parts)} parts")
    return with_unique_names(parts)


def repair_parts(parts: Sequence[Part], *, allow_surface: bool) -> list[Part]:
    """Repair the meshes of parts as `repair_part` does, in several processes if they are large.

    Raises
    ------
    MeshError
        For the first part that `repair_part` refuses.
    """
    work = [_REPAIR_WORK * len(part.mesh.triangles) for part in parts]
    repaired = share_out(lambda number: _repaired(parts[number], allow_surface=allow_surface), work)
    return [_with_mesh(part, mesh) for part, mesh in zip(parts, repaired, strict=True)]


def repair_part(part: Part, *, allow_surface: bool) -> Part:
    """Repair the mesh of a part; return the part with its volume and a note on every repair.

    Raises
    ------
    MeshError
        When the mesh is unusable, or it is not a solid and surfaces are not allowed.
    """
    return _with_mesh(part, _repaired(part, allow_surface=allow_surface))


def _repaired(part: Part, *, allow_surface: bool) -> RepairedMesh:
    """Return the repaired mesh of a part; for errors, see `repair_part`."""
    defect = find_defect(part.mesh.vertices, part.mesh.triangles)
    if defect:
        raise MeshError(f"{_where(part)}: {defect}; export it again from the program that made it")
    repaired = repair_mesh(part.mesh.vertices, part.mesh.triangles)
    if repaired.problem and (not allow_surface or len(repaired.triangles) == 0):
        advice = "repair it, or use --allow-surface to accept it as a surface"
        raise MeshError(f"{_where(part)} is not a solid: {repaired.problem}; {advice}")
    return repaired


def warnings_about(parts: Sequence[Part]) -> list[str]:
    """Return the warnings of the parts with the names of their files."""
    return [
        f"{Path(part.source).name or part.name}: {warning}" for part in parts for warning in part.warnings
    ]


def with_unique_names(parts: Sequence[Part]) -> list[Part]:
    """Return the parts with unique names: ``bracket``, ``bracket-2``, ``bracket-3``."""
    taken = {part.name for part in parts}
    seen: set[str] = set()
    unique = []
    for part in parts:
        name = part.name
        if name in seen:
            number = 2
            while f"{name}-{number}" in taken:
                number += 1
            name = f"{name}-{number}"
        seen.add(name)
        taken.add(name)
        unique.append(part if name == part.name else replace(part, name=name))
    return unique


def _expand(path: Path, suffixes: Collection[str]) -> list[Path]:
    if not str(path).isprintable():
        raise InputError(f"{str(path)[:80]!r} is not a usable file name")
    try:
        if path.is_dir():
            return _files_in(path, suffixes)
        if not path.exists():
            raise InputError(f"{path}: no such file or folder{_hint_for(path)}")
        if not path.is_file():
            raise InputError(f"{path}: expected a file or a folder, got something else")
    except OSError as error:
        raise InputError(f"{str(path)[:200]}: cannot be accessed: {error.strerror or error}") from error
    return [path]


def _hint_for(path: Path) -> str:
    """Return what a path that does not exist may mean: a file with a wrong count, or one with a similar name."""
    stem, colon, _ = path.name.rpartition(":")
    if colon and path.with_name(stem).is_file():
        return f"; a count of copies must be a whole number, as in {stem}:4"
    beside = (
        (each.name for each in islice(path.parent.iterdir(), _MOST_FILES)) if path.parent.is_dir() else ()
    )
    close = get_close_matches(path.name, list(beside), n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""


def _files_in(folder: Path, suffixes: Collection[str]) -> list[Path]:
    """Return the files to read in a folder and its subfolders, sorted by path."""
    found: list[Path] = []
    for here, folders, names in os.walk(folder, onerror=_refuse):
        folders[:] = sorted(each for each in folders if not each.startswith("."))
        paths = [Path(here, name) for name in names if not (name.startswith(".") or _OF_A_RUN.search(name))]
        found += [path for path in paths if path.suffix.lower() in suffixes and path.is_file()]
        if len(found) > _MOST_FILES:
            raise InputError(
                f"{folder}: more than {_MOST_FILES} files to read; name the folders with the parts"
            )
    if not found:
        raise InputError(
            f"{folder}: no file to read in this folder (known suffixes: {', '.join(sorted(suffixes))})"
        )
    return sorted(found)


def _refuse(error: OSError) -> NoReturn:
    """Raise the error of a folder that cannot be read: without it, parts would be missing without a word."""
    raise error


def _where(part: Part) -> str:
    return f"{part.source}: {part.name}" if part.source else part.name


def _with_mesh(part: Part, repaired: RepairedMesh) -> Part:
    """Return the part with the repaired mesh, and with its regions and colours on the triangles that are left."""
    same = np.array_equal(repaired.vertices, part.mesh.vertices) and np.array_equal(
        repaired.triangles, part.mesh.triangles
    )
    note = (f"not a solid: {repaired.problem}; taken as a surface",) if repaired.problem else ()
    return replace(
        part,
        mesh=part.mesh if same else Mesh(repaired.vertices, repaired.triangles),
        volume_mm3=repaired.volume,
        is_solid=not repaired.problem,
        notes=(*part.notes, *repaired.notes, *note),
        regions=tuple(_follow(region, repaired, len(part.mesh.triangles)) for region in part.regions),
        appearance=_recoloured(part.appearance, repaired),
    )


def _follow(region: Region, repaired: RepairedMesh, triangles_before: int) -> Region:
    if region.triangles is None:
        return region
    after = np.full(triangles_before, -1, np.int32)
    after[repaired.kept] = np.arange(len(repaired.kept))
    triangles = after[region.triangles]
    mesh = region.mesh and Mesh(region.mesh.vertices, region.mesh.triangles[triangles >= 0])
    return replace(region, triangles=triangles[triangles >= 0], mesh=mesh)


def _recoloured(appearance: Appearance, repaired: RepairedMesh) -> Appearance:
    if appearance.triangle_colours is None:
        return appearance
    colours = np.asarray(appearance.triangle_colours)[repaired.kept]
    colours = np.where(repaired.turned[:, None], colours[:, ::-1], colours)
    return replace(appearance, triangle_colours=colours)


Read = Callable[[Path], list[Part]]


@dataclass(frozen=True, eq=False, repr=False)
class LoadedParts(Summarised):
    """Parts that were read and checked, with the job that they belong to.

    Attributes
    ----------
    resolved
        The job with the offers that it names.
    parts
        The parts in the order of the inputs; names are unique.
    notes
        Sentences for the user that concern no single part.
    """

    resolved: ResolvedJob
    parts: tuple[Part, ...]
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Summary in one line."""
        copies = sum(part.quantity for part in self.parts)
        names = ", ".join(part.name for part in self.parts)
        parts = "1 part" if len(self.parts) == 1 else f"{len(self.parts)} parts"
        return f"{parts}, {'1 copy' if copies == 1 else f'{copies} copies'}: {names}"


def read_job(
    resolved: ResolvedJob,
    clock: Clock,
    *,
    more: Sequence[Part] = (),
    allow_surface: bool = False,
) -> LoadedParts:
    """Read every input of the job and apply the settings of its ``[[part]]`` entries.

    Parameters
    ----------
    resolved
        Job with the offers that it names.
    clock
        Times and shows the stage ``read``.
    more
        Further parts, which are in no file; they are checked and repaired like the others.
    allow_surface
        Whether meshes that are not solids are accepted as surfaces.

    Raises
    ------
    InputError, MeshError, JobError
        For the first file or part that cannot be read, or an entry that names no part.
    """
    job = resolved.job
    with clock.stage("read") as progress:
        files = expand_inputs([(entry.path, entry.quantity) for entry in job.inputs], resolved.host.suffixes)
        parts = read_all(files, resolved.read, allow_surface=allow_surface, progress=progress)
        parts += repair_parts(more, allow_surface=allow_surface)
        parts = [with_unit_question(part, job) for part in parts]
        parts = apply_part_settings(with_unique_names(parts), job)
        parts = with_unique_names(labelled(with_region_files(parts, job, resolved.read), job.labels))
        return LoadedParts(resolved, tuple(parts))


def with_region_files(parts: Sequence[Part], job: Job, read: Read) -> list[Part]:
    """Return the parts with the blockers and enforcers of their ``[[part]]`` entries.

    The coordinates of a blocker or enforcer are those of the part. Meshes of a 3MF file are at the positions of its
    build items.

    Parameters
    ----------
    parts
        Parts of the job.
    job
        Job with the ``[[part]]`` entries.
    read
        Reads one file and returns its parts.

    Raises
    ------
    JobError, InputError, MeshError
        When a file does not exist, cannot be read, or contains a mesh that is not closed.
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
        raise JobError(
            f"{job.source}: [[part]]: blockers and enforcers must be mesh files, found no file at {path}"
        )
    return read(path)


def _closed(part: Part, kind: RegionKind, file: str) -> list[Mesh]:
    """Return the solid of the part at each of its positions."""
    repaired = repair_mesh(part.mesh.vertices, part.mesh.triangles)
    if repaired.problem:
        raise MeshError(
            f"{file}: expected closed meshes for {kind}s, {part.name} is not closed: {repaired.problem}"
        )
    return [Mesh(repaired.vertices + position, repaired.triangles) for position in part.origins]
