"""Read the inputs of an inspection; a part whose mesh cannot be used is kept with the reason."""

from dataclasses import replace
from pathlib import Path

from amprep.errors import InputError, MeshError
from amprep.job import apply_part_settings
from amprep.model import Part, Progress
from amprep.pipeline.reading import expand_inputs, repair_part, with_region_files, with_unique_names
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.unit_question import with_unit_question
from amprep.report.inspection.record import InspectedFile

_WITH_UNIT = {
    ".3mf": "millimetre",
    ".step": "millimetre",
    ".stp": "millimetre",
    ".glb": "metre",
    ".gltf": "metre",
}
"""Suffix -> unit of formats that state it, unless a note of the reader names another one."""


def read_for_inspection(
    resolved: ResolvedJob, progress: Progress
) -> tuple[list[InspectedFile], list[tuple[Part, str]]]:
    """Read and repair every part of a job, and apply the settings of its ``[[part]]`` entries.

    Returns
    -------
    files
        The files.
    parts
        The parts, each with the reason why its mesh cannot be used; empty if it can.

    Raises
    ------
    InputError, JobError
        For a single file that cannot be read, or an entry that names no part. One file of several that cannot be read
        is in `files` with the reason.
    """
    job = resolved.job
    paths = expand_inputs([(entry.path, entry.quantity) for entry in job.inputs], resolved.host.suffixes)
    files: list[InspectedFile] = []
    parts: list[Part] = []
    problems: list[str] = []
    for done, (path, count) in enumerate(paths):
        progress(done / len(paths), path.name)
        try:
            read = resolved.read(path)
        except InputError as error:
            if len(paths) == 1:
                raise
            files.append(_unread(path, resolved, error))
            continue
        files.append(_file(path, read, resolved))
        for part in read:
            repaired, problem = _repaired(part)
            repaired = with_unit_question(repaired, job)
            parts.append(replace(repaired, quantity=repaired.quantity * (count or 1)))
            problems.append(problem)
    parts = apply_part_settings(with_unique_names(parts), job)
    return files, list(zip(with_region_files(parts, job, resolved.read), problems, strict=True))


def _repaired(part: Part) -> tuple[Part, str]:
    try:
        return repair_part(part, allow_surface=True), ""
    except MeshError as error:
        return part, str(error)


def _unread(path: Path, resolved: ResolvedJob, error: InputError) -> InspectedFile:
    reader = resolved.host.reader_for(path, resolved.job.reading.readers).offer.name
    return InspectedFile(str(path), reader, path.stat().st_size, "none", 0, str(error))


def _file(path: Path, parts: list[Part], resolved: ResolvedJob) -> InspectedFile:
    reader = resolved.host.reader_for(path, resolved.job.reading.readers).offer.name
    scaled = [note for part in parts for note in part.notes if note.startswith("scaled from ")]
    stated = scaled[0].removeprefix("scaled from ").split(" ")[0].rstrip(",") if scaled else ""
    unit = stated or _WITH_UNIT.get(path.suffix.lower(), "none")
    return InspectedFile(str(path), reader, path.stat().st_size, unit, len(parts))
