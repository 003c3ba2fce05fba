"""Find what an edited file was made from: its own record, the report of its run, a build file beside it, or a job."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE
from amprep.checks.printed.found import PrintedBody
from amprep.errors import InputError
from amprep.files import read_json
from amprep.geometry.meshes.sampling import triangle_areas
from amprep.host import Host
from amprep.job import Job
from amprep.job.planning import job_of_build
from amprep.measures.differences.find import settings_differences
from amprep.measures.differences.records import SettingDifference
from amprep.model import Build, BuildSettings, Mesh, PlacedPart
from amprep.pipeline.packing import labels
from amprep.pipeline.reading import read_job
from amprep.pipeline.resolve import ResolvedJob, resolve
from amprep.pipeline.stages import Clock
from amprep.pipeline.verifying.order import settings_for
from amprep.sealing.seal import file_digest
from amprep.threemf.build.identifier import read_identifier

if TYPE_CHECKING:
    from amprep.threemf import EditedFile

LARGEST_REPORT = 256 * 1024 * 1024
"""Largest report, bytes."""
_OF_NO_SUPPORT = (
    "build_id",
    "printer",
    "space.",
    "plate_origin",
    "planning.seed",
    "planning.supports.memory_mb",
)
"""Beginnings of the names of settings that supports do not depend on, as long as they are inside the build volume."""
_MOST_FILES = 5000
"""Most build files that are looked at beside an edited file."""


@dataclass(frozen=True, eq=False)
class BuildSource:
    """What an edited file was made from.

    Attributes
    ----------
    original
        The build as it was written; of a job, its parts at the origin.
    deleted
        Number of parts that are gone and of which nothing is known.
    resolved
        The job by which supports are planned again.
    words
        Where it was found.
    places_known
        False if only a job is known, so that every part counts as new.
    bodies
        The bodies in the edited file, mm from the corner of the plate.
    other_settings
        Names of the settings of a job by which the supports of the build were not planned, so that none is kept.
        `original` has the settings of the job.
    """

    original: Build
    deleted: int
    resolved: ResolvedJob
    words: str
    places_known: bool
    bodies: tuple[PrintedBody, ...]
    other_settings: tuple[str, ...] = ()


def find_source(path: Path, *, job: Job | None, report: Path | None, host: Host, clock: Clock) -> BuildSource:
    """Return what an edited file was made from.

    Parameters
    ----------
    path
        The edited file.
    job
        The job by which supports are planned, instead of the recorded settings; None for these.
    report
        JSON report of the run, beside the build file that was edited; None to do without.
    host
        Offers of plugins.
    clock
        Times and shows the stage ``read``.

    Raises
    ------
    InputError
        If a file cannot be read, or nothing says what the file was made from.
    JobError, PluginError
        If the job is wrong, or the recorded settings cannot be used.
    """
    from amprep.threemf import read_edited_file

    with clock.stage("read"):
        file = read_edited_file(path)
        original, words = _original(path, file, report)
    if original is None:
        if job is None:
            raise InputError(_nothing_known(path, file))
        return _of_job(file, resolve(job, host), clock)
    deleted = file.deleted if file.recorded is original else 0
    bodies = _on_plate(file, original)
    if job is not None:
        resolved = resolve(_completed(job, original.settings), host)
        words, settings = f"{words}; supports by {job.source}", settings_for(resolved, original)
        ordered = replace(original, settings=settings)
        others = _that_matter(settings_differences(original.settings, settings))
        return BuildSource(ordered, deleted, resolved, words, True, bodies, others)
    if not original.settings.planning:
        raise InputError(
            f"{path}: the build was written by an earlier version, which did not record how supports were "
            "planned; give its job by --job JOB.toml"
        )
    resolved = resolve(job_of_build(original.settings, path), host)
    return BuildSource(original, deleted, resolved, words, True, bodies)


def _completed(job: Job, settings: BuildSettings) -> Job:
    """Return a job with the printer and the target of a build where it states none."""
    printer, target = job.printer, job.target
    if job.printer_is_default:
        printer = replace(printer, name=settings.printer, space=settings.space)
    return replace(job, printer=printer, target=target if "target" in job.table else settings.target)


def _that_matter(found: Iterable[SettingDifference]) -> tuple[str, ...]:
    """Return the names of settings that supports depend on."""
    return tuple(each.name for each in found if not each.name.startswith(_OF_NO_SUPPORT))


def _original(path: Path, file: "EditedFile", report: Path | None) -> tuple[Build | None, str]:
    """Return the build that the file was made from, and where it was found."""
    if report is not None:
        found = _reported(report, file)
        return _read(found), f"made from {found.name}, by {report.name}"
    recorded = file.recorded
    if recorded is not None and not _has_changed_bodies(recorded):
        return recorded, "made from the build that the file records"
    beside = sorted(each for each in path.resolve().parent.glob("*.3mf") if each.name != path.name)
    for each in beside[:_MOST_FILES] if file.identifiers else ():
        if read_identifier(each) in file.identifiers and (build := _read(each)) is not None:
            return build, f"made from {each.name}, by the identifier in names of objects"
    if recorded is not None:
        words = "made from the build that the file records, with coordinates that another program rounded"
        return _as_rounded(recorded, path), words
    return None, ""


def _has_changed_bodies(build: Build) -> bool:
    """Return whether a part or support has other triangles than amprep wrote, by its digest."""
    stored = [body.stored for body in build.supports if body.stored is not None]
    return any(_is_changed(each) for each in build.parts) or any(
        each.recorded_digest not in ("", each.digest) for each in stored
    )


def _is_changed(placed: PlacedPart) -> bool:
    return placed.recorded_digest not in ("", placed.part.mesh.digest)


def _as_rounded(build: Build, path: Path) -> Build:
    """Return a build whose parts are as they are in a file that another program saved with rounded coordinates.

    A rounded part has the recorded volume, up to what a thin skin contributes.

    Raises
    ------
    InputError
        If a part has another volume than the build recorded.
    """
    for each in build.parts:
        mesh, volume = each.part.mesh, each.part.volume_mm3
        area = float(triangle_areas(mesh.vertices[mesh.triangles]).sum())
        if _is_changed(each) and abs(mesh.signed_volume - volume) > CONTACT_TOLERANCE * area:
            raise InputError(
                f"{path}: {each.label} has another shape than the build recorded: it was cut, repaired or replaced; "
                "run the job again with the new shape"
            )
    return replace(build, parts=tuple(replace(each, recorded_digest="") for each in build.parts))


def _read(path: Path) -> Build | None:
    """Return the build that a file records; None if parts of it are gone or changed, since it was edited, too."""
    from amprep.threemf import read_edited_file

    file = read_edited_file(path)
    whole = file.recorded is not None and not file.deleted and not _has_changed_bodies(file.recorded)
    return file.recorded if whole else None


def _reported(report: Path, file: "EditedFile") -> Path:
    """Return the build file that a report states and that the edited file was made from.

    Raises
    ------
    InputError
        If the report names no such file, or it is not beside the report as it was written.
    """
    record = read_json(report, "NAME.report.json of amprep", LARGEST_REPORT)
    builds = record.get("builds") if isinstance(record, dict) else None
    entries = [each for each in builds if isinstance(each, dict)] if isinstance(builds, list) else []
    stated = [(each.get("file"), each.get("sha256")) for each in entries]
    stated += [(record.get("file"), record.get("sha256"))] if isinstance(record, dict) else []
    present = [
        (report.parent / name, digest) for name, digest in stated if isinstance(name, str) and _is_name(name)
    ]
    whole = [path for path, digest in present if path.is_file() and file_digest(path) == digest]
    named = [each for each in whole if read_identifier(each) in file.identifiers]
    if len(named or whole) != 1:
        raise InputError(
            f"{report}: expected one build file of this report beside it, unchanged, got {len(named or whole)}; "
            "give the report of the run that made the build, in its folder"
        )
    return (named or whole)[0]


def _is_name(name: str) -> bool:
    return Path(name).name == name and name.lower().endswith(".3mf")


def _nothing_known(path: Path, file: "EditedFile") -> str:
    named = f" (its objects name the build {file.identifiers[0]})" if file.identifiers else ""
    return (
        f"{path}: the record of amprep is gone{named}: slicers drop it when they save; put the file beside the build "
        "file that was edited, or give --report REPORT.json of its run, or its job by --job JOB.toml"
    )


def _of_job(file: "EditedFile", resolved: ResolvedJob, clock: Clock) -> BuildSource:
    """Return a job as the source: its parts without places, so that all supports are planned again."""
    loaded = read_job(resolved, clock)
    parts = tuple(
        PlacedPart(label, loaded.parts[index], np.eye(4), loaded.parts[index].orientations)
        for (index, _), label in sorted(labels(loaded.parts).items())
    )
    build = Build(settings_for(resolved, Build(_no_settings(resolved), parts)), parts)
    words = f"parts and settings by {resolved.job.source}; the file has no record, so all supports are planned again"
    return BuildSource(build, 0, resolved, words, False, _on_plate(file, build))


def _no_settings(resolved: ResolvedJob) -> Any:
    from amprep.pipeline.supporting import build_settings

    return build_settings(resolved.job, resolved.job.name, 1.0)


def _on_plate(file: "EditedFile", build: Build) -> tuple[PrintedBody, ...]:
    """Return the bodies of a file, from the corner of the plate: PrusaSlicer counts from the origin of the machine."""
    x, y = build.settings.plate_origin
    return tuple(_moved(file.bodies, -x, -y)) if x or y else file.bodies


def _moved(bodies: Iterable[PrintedBody], x: float, y: float) -> Iterable[PrintedBody]:
    for each in bodies:
        beams = each.beams and replace(each.beams, ends=each.beams.ends + (x, y, 0.0))
        mesh = Mesh(each.mesh.vertices + (x, y, 0.0), each.mesh.triangles)
        yield replace(each, mesh=mesh, beams=beams)
