"""Write the files of a build, verify the build as read back from its file, and write the reports."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

from amprep.job import Job
from amprep.model import Build, Progress, Stop, silent
from amprep.pipeline.outputs import REPORTS, OutputFolder, safe_name
from amprep.pipeline.record import build_record
from amprep.pipeline.stages import Clock
from amprep.pipeline.supporting import SupportedBuild
from amprep.pipeline.verifying.build import Verification, verify_build
from amprep.report.record import BuildRecord, RunRecord
from amprep.sealing.seal import file_digest
from amprep.workers import share_out


class BuildFiles(NamedTuple):
    """Names of the files of a build, and the SHA-256 of its build file, as in `BuildRecord`."""

    file: str
    sha256: str
    stl_files: tuple[str, ...]


# Strategy. Builds do not depend on one another, so they are written, verified and drawn in the processes of
# `workers`, stage by stage. A process returns the names of its files and its judgement, and not the build, which
# this one has.

_FILE_WORK, _PICTURE_WORK = 20.0, 5.0
"""Work of writing and judging a build, and of drawing it, by its triangles; the judges do what the supports take."""


def finish_builds(
    supported: Sequence[SupportedBuild],
    job: Job,
    outputs: OutputFolder,
    *,
    dry_run: bool,
    stl: bool,
    clock: Clock,
    stop: Stop,
) -> list[BuildRecord]:
    """Write and verify builds, and return their records.

    Parameters
    ----------
    supported
        The builds with their supports.
    job
        Their job, of which material and layer height determine mass and hours.
    outputs
        Folder of the files.
    dry_run
        Write nothing, and verify the builds as planned instead of as read back from their files.
    stl
        Write an STL file of each part and support, too.
    clock, stop
        Time the stages; end measurement and verification early.
    """
    with clock.stage("measure"):
        records = [build_record(each, job, stop) for each in supported]
    builds = [each.build for each in supported]
    if not dry_run:
        with clock.stage("write") as progress:
            records = _written(records, outputs, stl, progress)
    with clock.stage("verify") as progress:
        judged = _judged(builds, None if dry_run else outputs, stop, progress)
        return [
            replace(record, verification=each.violations, pairs=each.pairs)
            for record, each in zip(records, judged, strict=True)
        ]


def write_reports(record: RunRecord, outputs: OutputFolder, clock: Clock) -> RunRecord:
    """Write pictures and the HTML and JSON reports; return the record with durations and file names.

    Parameters
    ----------
    record
        The record of the run.
    outputs
        Folder of the files.
    clock
        Times the stage; its durations are part of the reports.
    """
    from amprep.report.json_report import write_json
    from amprep.report.page.html import write_html
    from amprep.report.picture import write_picture
    from amprep.report.placements import write_placements
    from amprep.report.triage.findings import build_findings

    with clock.stage("report") as progress:

        def draw(number: int) -> None:
            picture = outputs.path(outputs.of_build(number + 1, "png"))
            write_picture(
                record.builds[number].build, picture, build_findings(record.builds[number], number + 1)
            )

        names = [outputs.name(outputs.of_build(number, "png")) for number in range(1, len(record.builds) + 1)]
        work = [_PICTURE_WORK * _triangles(each.build) for each in record.builds]
        share_out(draw, work, done=_counted(progress, len(names), "pictures"))
        outputs.add(names)
        builds = [replace(each, picture=name) for each, name in zip(record.builds, names, strict=True)]
        record = replace(record, builds=tuple(builds))
        write_html(replace(record, stages=clock.times), outputs.path("report.html"))
    record = replace(record, stages=clock.times)
    write_json(record, outputs.path("report.json"))
    write_placements(record, outputs.path("placements.csv"))
    return replace(record, report_files=tuple(outputs.name(name) for name in REPORTS))


def _written(
    records: Sequence[BuildRecord], outputs: OutputFolder, stl: bool, progress: Progress
) -> list[BuildRecord]:
    """Write the files of builds, and return the records with their names."""
    from amprep.threemf import write_build

    def write(number: int) -> BuildFiles:
        build, name = records[number].build, outputs.of_build(number + 1, "3mf")
        write_build(build, outputs.path(name))
        stl_files = _write_stl(build, number + 1, outputs) if stl else ()
        return BuildFiles(outputs.name(name), file_digest(outputs.staged(name)), stl_files)

    work = [_FILE_WORK * _triangles(each.build) for each in records]
    written = share_out(write, work, all_long=True, done=_counted(progress, len(records), "files"))
    outputs.add(name for each in written for name in (each.file, *each.stl_files))
    return [replace(record, **each._asdict()) for record, each in zip(records, written, strict=True)]


def _judged(
    builds: Sequence[Build], outputs: OutputFolder | None, stop: Stop, progress: Progress
) -> list[Verification]:
    """Verify builds as read back from their files, or as they are if there is no folder."""
    from amprep.threemf import read_build_file

    def judge(number: int) -> Verification:
        report = progress if len(builds) == 1 else silent
        if outputs is None:
            return verify_build(builds[number], stop=stop, progress=report)
        file = read_build_file(outputs.staged(outputs.of_build(number + 1, "3mf")))
        return verify_build(file.build, printed=file.printed, stop=stop, progress=report)

    work = [_FILE_WORK * _triangles(build) for build in builds]
    done = silent if len(builds) == 1 else progress
    judged = share_out(judge, work, is_cancelled=stop, done=_counted(done, len(builds), "builds"))
    return judged + [judge(number) for number in range(len(judged), len(builds))]


def _counted(progress: Progress, count: int, noun: str) -> Callable[[int], None]:
    """Return a callback that shows how many of a number of things are done."""
    return lambda done: progress(done / count, f"{done} of {count} {noun}")


def _triangles(build: Build) -> float:
    """Return the number of triangles of the parts and supports of a build."""
    meshes = [each.mesh for each in build.parts] + [each.mesh for each in build.supports]
    return float(sum(len(mesh.triangles) for mesh in meshes))


def _write_stl(build: Build, number: int, outputs: OutputFolder) -> tuple[str, ...]:
    """Write parts and supports in build coordinates; return the names of the files."""
    from amprep.stl import write_stl

    meshes = [(placed.label, placed.mesh) for placed in build.parts]
    meshes += [(body.name, body.mesh) for body in build.supports]
    names = []
    for index, (label, mesh) in enumerate(meshes, start=1):
        suffix = outputs.of_build(number, f"{index:03d}.{safe_name(label)}.stl")
        write_stl(mesh, outputs.path(suffix))
        names.append(outputs.name(suffix))
    return tuple(names)
