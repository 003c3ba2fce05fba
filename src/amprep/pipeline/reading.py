"""From what the user names to parts: folders and counts expanded, meshes repaired, names made unique."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from amprep.errors import InputError, JobError, MeshError
from amprep.geometry.meshes.repair import RepairedMesh, find_defect, repair_mesh
from amprep.job import Job, PartSettings, names_part
from amprep.model.control import Progress, silent
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance, Part, Region, RegionKind


def expand_inputs(
    inputs: Sequence[tuple[Path, int | None]], suffixes: Collection[str]
) -> list[tuple[Path, int | None]]:
    """Return the files to read with the counts asked for, in order.

    A folder stands for the files in it (not in folders below) whose suffix is known, by name; its count
    holds for each of them.

    Raises
    ------
    InputError
        If something is not there, or a folder holds nothing to read.
    """
    return [(file, count) for path, count in inputs for file in _expand(path, suffixes)]


def read_all(
    files: Sequence[tuple[Path, int | None]],
    read: Callable[[Path], list[Part]],
    *,
    allow_surface: bool = False,
    progress: Progress = silent,
) -> list[Part]:
    """Read and settle the files in order; a count multiplies the quantity of each part of its file.

    Parameters
    ----------
    files
        As `expand_inputs` returns them.
    read
        Turns one file into parts, by the reader chosen for its suffix.

    Raises
    ------
    InputError, MeshError
        For the first file or part that cannot be read.
    """
    parts: list[Part] = []
    for done, (path, count) in enumerate(files):
        progress(done / len(files), path.name)
        for part in read(path):
            repaired = repair_part(part, allow_surface=allow_surface)
            parts.append(replace(repaired, quantity=repaired.quantity * (count or 1)))
    progress(1.0, f"{len(parts)} parts")
    return with_unique_names(parts)


def repair_part(part: Part, *, allow_surface: bool) -> Part:
    """Return the part as manifold3d accepts it, with its volume and notes on what was mended.

    Raises
    ------
    MeshError
        If it is no solid and surfaces are not allowed, or no mesh at all.
    """
    defect = find_defect(part.mesh.vertices, part.mesh.triangles)
    if defect:
        raise MeshError(f"{_where(part)}: {defect}; export it again from the program it was drawn in")
    repaired = repair_mesh(part.mesh.vertices, part.mesh.triangles)
    if repaired.problem and (not allow_surface or len(repaired.triangles) == 0):
        advice = "repair it, or use --allow-surface to take it as it is"
        raise MeshError(f"{_where(part)} is not a solid: {repaired.problem}; {advice}")
    return _with_mesh(part, repaired)


def with_unique_names(parts: Sequence[Part]) -> list[Part]:
    """Return the parts with names that differ: ``bracket``, ``bracket-2``, ``bracket-3``."""
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
            raise InputError(f"{path}: no such file or folder")
        if not path.is_file():
            raise InputError(f"{path}: expected a file or a folder, this is neither")
    except OSError as error:
        raise InputError(f"{str(path)[:200]}: cannot look it up: {error.strerror or error}") from error
    return [path]


def _files_in(folder: Path, suffixes: Collection[str]) -> list[Path]:
    files = [file for file in sorted(folder.iterdir()) if file.suffix.lower() in suffixes and file.is_file()]
    files = [file for file in files if not file.name.startswith(".")]
    if not files:
        raise InputError(f"{folder}: no file to read in this folder (known: {', '.join(sorted(suffixes))})")
    return files


def _where(part: Part) -> str:
    return f"{part.source}: {part.name}" if part.source else part.name


def _with_mesh(part: Part, repaired: RepairedMesh) -> Part:
    """Return the part with the repaired mesh; what belongs to triangles follows them."""
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
    repaired = repair_mesh(part.mesh.vertices, part.mesh.triangles)
    if repaired.problem:
        raise MeshError(
            f"{file}: expected closed meshes for {kind}s, {part.name} is none: {repaired.problem}"
        )
    positions = np.zeros((1, 3)) if part.positions is None else part.positions
    return [Mesh(repaired.vertices + position, repaired.triangles) for position in positions]
