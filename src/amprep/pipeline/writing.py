"""Write the files of a build, verify the build as read back from its file, and write the reports."""

from dataclasses import replace
from typing import TYPE_CHECKING

from amprep.job import Job
from amprep.model import Build, Stop
from amprep.pipeline.outputs import REPORTS, OutputFolder, safe_name
from amprep.pipeline.record import build_record
from amprep.pipeline.stages import Clock
from amprep.pipeline.supporting import SupportedBuild
from amprep.pipeline.verifying.build import verify_build
from amprep.report.record import BuildRecord, RunRecord
from amprep.sealing.seal import file_digest

if TYPE_CHECKING:
    from amprep.threemf import BuildFile


def finish_build(
    supported: SupportedBuild,
    job: Job,
    number: int,
    outputs: OutputFolder,
    dry_run: bool,
    stl: bool,
    clock: Clock,
    stop: Stop,
) -> BuildRecord:
    """Write and verify a build.

    Parameters
    ----------
    supported
        The build with its supports.
    job
        Its job, of which material and layer height determine mass and hours.
    number
        Number of the build, from 1.
    outputs
        Folder of the files.
    dry_run
        Write nothing, and verify the build as planned instead of as read back from its file.
    stl
        Write an STL file of each part and support, too.
    clock, stop
        Time the stages; end measurement and verification early.
    """
    build = supported.build
    with clock.stage("measure"):
        record = build_record(supported, job, stop)
    if not dry_run:
        with clock.stage("write"):
            record = _written(record, number, outputs, stl)
    with clock.stage("verify") as progress:
        if dry_run:
            judged = verify_build(build, stop=stop, progress=progress)
        else:
            file = _read_back(number, outputs)
            judged = verify_build(file.build, printed=file.printed, stop=stop, progress=progress)
        return replace(record, verification=judged.violations, pairs=judged.pairs)


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
        builds = []
        for number, each in enumerate(record.builds, start=1):
            progress((number - 1) / (len(record.builds) + 1), f"picture {number}")
            name = outputs.of_build(number, "png")
            write_picture(each.build, outputs.path(name), build_findings(each, number))
            builds.append(replace(each, picture=outputs.name(name)))
        record = replace(record, builds=tuple(builds))
        write_html(replace(record, stages=clock.times), outputs.path("report.html"))
    record = replace(record, stages=clock.times)
    write_json(record, outputs.path("report.json"))
    write_placements(record, outputs.path("placements.csv"))
    return replace(record, report_files=tuple(outputs.name(name) for name in REPORTS))


def _read_back(number: int, outputs: OutputFolder) -> "BuildFile":
    from amprep.threemf import read_build_file

    return read_build_file(outputs.staged(outputs.of_build(number, "3mf")))


def _written(record: BuildRecord, number: int, outputs: OutputFolder, stl: bool) -> BuildRecord:
    from amprep.threemf import write_build

    name = outputs.of_build(number, "3mf")
    write_build(record.build, outputs.path(name))
    stl_files = _write_stl(record.build, number, outputs) if stl else ()
    sha256 = file_digest(outputs.staged(name))
    return replace(record, file=outputs.name(name), sha256=sha256, stl_files=stl_files)


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
