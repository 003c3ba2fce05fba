"""Plan an edited build again: read, recognise, keep what holds, plan the rest, write and verify."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from amprep.checks.packing.motion import motion_fault
from amprep.checks.packing.parts_placed import check_placed
from amprep.errors import InputError
from amprep.files import read_json
from amprep.geometry.motions.rigid import angle_deg, displacement
from amprep.host import Host
from amprep.job import Job
from amprep.model import Build, Orientations, Stop
from amprep.model.counting import counted
from amprep.pipeline.outputs import OutputFolder, safe_name
from amprep.pipeline.replanning.keep import Kept, choose_kept
from amprep.pipeline.replanning.page import PAGE, write_page
from amprep.pipeline.replanning.plan import bodies_of, plan_again
from amprep.pipeline.replanning.recognise import recognise
from amprep.pipeline.replanning.records import EditedBuild, EditedPart
from amprep.pipeline.replanning.source import LARGEST_REPORT, BuildSource, find_source
from amprep.pipeline.stages import Clock, Watcher
from amprep.pipeline.verifying.build import Verification, verify_build
from amprep.report.json_values import write_json_file
from amprep.report.replanning import ReplannedPart, ReplanRecord, SupportsOf, to_json
from amprep.sealing.seal import file_digest

_MOST_NAMED = 8
"""Faults of the placement that a message names."""
NO_SUPPORTS = "the settings ask for no supports; --job JOB.toml plans them by the settings of a job"
_NUMBERED = re.compile(r"(.*\.replanned)(?:-(\d+))?")


@dataclass(frozen=True)
class ReplanOptions:
    """Options of planning again.

    Attributes
    ----------
    folder
        Output folder.
    report
        JSON report of the run that made the build; None to do without.
    dry_run
        Whether everything is planned and verified, but nothing is written.
    verify_all
        Whether supports that are kept are judged, too.
    time_limit
        Seconds after which routing ends with its best result so far; None for no limit.
    page
        Whether the page that a run gives is written, too.
    force
        Whether a build file of the new name is replaced although it was changed since it was planned again.
    """

    folder: Path
    report: Path | None = None
    dry_run: bool = False
    verify_all: bool = False
    time_limit: float | None = None
    page: bool = False
    force: bool = False


def replan_build(
    path: Path, options: ReplanOptions, *, job: Job | None, host: Host, watcher: Watcher, stop: Stop
) -> ReplanRecord:
    """Plan an edited build again, write it, and return what was kept and what was planned.

    Parameters
    ----------
    path
        The edited file.
    options
        Output folder and other options.
    job
        Job by which supports are planned, instead of the recorded settings; None for these.
    host
        Offers of plugins.
    watcher
        Shows the progress of every stage.
    stop
        Ends the work early.

    Raises
    ------
    AmprepError
        For wrong input, a part outside the build volume or too near to another, or a plugin that fails.
    """
    clock, limit, name = Clock(watcher), stop.within(options.time_limit), new_name(path)
    if not (options.force or options.dry_run):
        _keep_edits(options.folder, safe_name(name))
    source = find_source(path, job=job, report=options.report, host=host, clock=clock)
    with clock.stage("compare"):
        edited = recognise(source.bodies, source.original, places_known=source.places_known)
        edited, notes = _as_the_user_turned(edited)
        _refuse_faults(edited, source.original, stop)
        kept = choose_kept(edited, source.original, stop, source.other_settings)
    build = plan_again(edited, kept, source.original, source.resolved, name, clock, limit)
    record = _record(path, source, edited, kept, build)
    if not build.settings.supported:
        notes.append(NO_SUPPORTS)
    record = replace(record, notes=(*record.notes, *notes), judged_all=options.verify_all)
    only = None if options.verify_all else _changed(edited, kept)
    with OutputFolder(options.folder, name, numbered=False) as outputs:
        record = _finished(record, build, only, outputs, options.dry_run, clock, stop)
        if not options.dry_run:
            if options.page:
                write_page(record, build, source.resolved, outputs, clock, stop)
                record = replace(record, page_file=outputs.name(PAGE), stages=clock.times)
            write_json_file(to_json(record), outputs.path("report.json"))
            outputs.publish()
    return record


def new_name(path: Path) -> str:
    """Return the name of the build that is made from an edited file: ``NAME.replanned``, then ``NAME.replanned-2``."""
    numbered = _NUMBERED.fullmatch(path.stem)
    return f"{path.stem}.replanned" if numbered is None else f"{numbered[1]}-{int(numbered[2] or 1) + 1}"


def _keep_edits(folder: Path, name: str) -> None:
    """Refuse to replace a build that somebody changed since it was planned again: its report has another digest.

    Raises
    ------
    InputError
        If there is such a file.
    """
    file, report = folder / f"{name}.3mf", folder / f"{name}.report.json"
    if not file.exists():
        return
    try:
        stated = read_json(report, "NAME.report.json of amprep", LARGEST_REPORT)
        as_written = isinstance(stated, dict) and stated.get("sha256") == file_digest(file)
    except InputError:
        as_written = False
    if not as_written:
        raise InputError(
            f"{file} was changed since amprep wrote it; plan that file again, or use --force to replace it, or -o for "
            "another folder"
        )


def _as_the_user_turned(edited: EditedBuild) -> tuple[EditedBuild, list[str]]:
    """Allow the orientations that the user chose, with a note for each that the part did not allow before."""
    parts, notes = [], []
    for each in edited.parts:
        turn, placed = each.placed.matrix[:3, :3], each.placed
        if motion_fault(turn, placed.orientations):
            placed = replace(placed, orientations=Orientations("list", turn[None]))
            notes.append(f"{placed.label}: its settings do not allow this orientation, but you chose it")
        parts.append(replace(each, placed=placed))
    return replace(edited, parts=tuple(parts)), notes


def _refuse_faults(edited: EditedBuild, original: Build, stop: Stop) -> None:
    """Refuse parts that are outside the build volume, in one another or too near.

    Raises
    ------
    InputError
        With the names of these parts.
    """
    if not edited.parts:
        raise InputError("expected a part of a build in the file, got none")
    found = check_placed([each.placed for each in edited.parts], original.settings, stop)
    if found:
        whom = "it" if len(found) == 1 else "them"
        shown = "; ".join(f"{each.subject}: {each.message}" for each in found[:_MOST_NAMED])
        more = f"; and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
        raise InputError(
            f"{counted(len(found), 'part')} cannot stay there: {shown}{more}; move {whom} and try again"
        )


def _changed(edited: EditedBuild, kept: Kept) -> set[int]:
    """Return the parts that moved or were planned again."""
    return {
        number for number, each in enumerate(edited.parts) if each.change != "none" or number in kept.reasons
    }


def _finished(
    record: ReplanRecord,
    build: Build,
    only: set[int] | None,
    outputs: OutputFolder,
    dry_run: bool,
    clock: Clock,
    stop: Stop,
) -> ReplanRecord:
    """Write and verify the build; after a dry run it is verified as planned."""
    from amprep.threemf import read_build_file, write_build

    if not dry_run:
        with clock.stage("write"):
            write_build(build, outputs.path("3mf"))
            record = replace(
                record,
                file=outputs.name("3mf"),
                report_file=outputs.name("report.json"),
                sha256=file_digest(outputs.staged("3mf")),
            )
    with clock.stage("verify") as progress:
        if dry_run:
            judged: Verification = verify_build(build, only=only, stop=stop, progress=progress)
        else:
            file = read_build_file(outputs.staged("3mf"))
            judged = verify_build(file.build, printed=file.printed, only=only, stop=stop, progress=progress)
    return replace(record, violations=judged.violations, stages=clock.times)


def _record(path: Path, source: BuildSource, edited: EditedBuild, kept: Kept, build: Build) -> ReplanRecord:
    parts = [
        _part_record(number, each, kept, build, source.original) for number, each in enumerate(edited.parts)
    ]
    deleted = edited.deleted
    if source.deleted:
        deleted += (counted(source.deleted, "part"),)
    return ReplanRecord(
        edited=path.name,
        source=source.words,
        build_id=build.settings.build_id,
        parts=tuple(parts),
        deleted=deleted,
        unsupported=tuple(region for region in build.unsupported if not region.minor),
        notes=_notes(edited.parts),
    )


def _notes(parts: Sequence[EditedPart]) -> tuple[str, ...]:
    return tuple(
        f"{each.placed.label}: {note}"
        for each in parts
        if each.was is None
        for note in each.placed.part.notes
    )


def _part_record(number: int, each: EditedPart, kept: Kept, build: Build, original: Build) -> ReplannedPart:
    reason = kept.reasons.get(number, "")
    moved = turned = 0.0
    if each.was is not None and each.change != "added":
        bounds = original.parts[each.was].mesh.bounds
        moved = displacement(bounds, np.eye(4), each.motion)
        turned = angle_deg(each.motion) if each.change == "turned" else 0.0
    supports = _supports_of(number, each, reason, build)
    return ReplannedPart(each.placed.label, each.change, moved, turned, supports, reason)


def _supports_of(number: int, each: EditedPart, reason: str, build: Build) -> SupportsOf:
    if not build.settings.supported:
        return "not planned"
    has = bool(bodies_of(build, number))
    if reason:
        return "planned again" if has or _is_listed(build, number) else "none needed"
    if not has:
        return "none needed"
    return "kept" if each.change == "none" else "taken along"


def _is_listed(build: Build, part: int) -> bool:
    return any(region.part == part for region in build.unsupported)
