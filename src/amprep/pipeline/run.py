"""Run a job: read, bound, pack, support, write, verify and report."""

from dataclasses import dataclass, replace
from pathlib import Path

from amprep.model import Stop
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.packing import PackedParts, pack_parts
from amprep.pipeline.reading import LoadedParts, read_job
from amprep.pipeline.record import run_record
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock, SupportStops, Watcher
from amprep.pipeline.supporting import support_build
from amprep.pipeline.writing import finish_builds, write_reports
from amprep.report.record import RunRecord


@dataclass(frozen=True)
class RunOptions:
    """Options of a run that a job file does not have.

    Attributes
    ----------
    folder
        Output folder.
    dry_run
        Whether everything is planned and verified, but nothing is written.
    stl
        Whether parts and supports are written as STL files too, in build coordinates.
    allow_surface
        Whether meshes that are not solids are accepted as surfaces.
    time_limit
        Seconds after which packing and routing end with their best result so far, see `SupportStops`; None for no
        limit.
    """

    folder: Path
    dry_run: bool = False
    stl: bool = False
    allow_surface: bool = False
    time_limit: float | None = None


def run_job(resolved: ResolvedJob, options: RunOptions, *, watcher: Watcher, stop: Stop) -> RunRecord:
    """Prepare every build of a job and return the record of the run.

    The files appear together at the end, so an interrupted run leaves no file.

    Parameters
    ----------
    resolved
        Job with the offers that it names.
    options
        Output folder and other options.
    watcher
        Shows the progress of every stage.
    stop
        Ends the run early.

    Raises
    ------
    AmprepError
        For wrong input, a plugin that fails, or when nothing fits the build volume.
    """
    clock, stops = Clock(watcher), SupportStops.after(options.time_limit, stop)
    outputs = OutputFolder(options.folder, resolved.job.name)
    loaded = read_job(resolved, clock, allow_surface=options.allow_surface)
    packed = pack_parts(loaded, clock, stops.routing)
    return make_builds(loaded, packed, outputs, options, clock, stops)


def make_builds(
    loaded: LoadedParts,
    packed: PackedParts,
    outputs: OutputFolder,
    options: RunOptions,
    clock: Clock,
    stops: SupportStops,
) -> RunRecord:
    """Support, write and verify builds, write the reports, publish all files and return the record.

    Parameters
    ----------
    loaded, packed
        The parts of the job, and their builds.
    outputs
        The output folder, which is entered here.
    options
        Options of the run.
    clock
        Times and shows the stages.
    stops
        End the support of builds, and the judges, early with the best result so far.
    """
    with outputs:
        supported = [support_build(build, clock, stops.routing, stops.building) for build in packed.builds]
        records = finish_builds(
            supported,
            loaded.resolved.job,
            outputs,
            dry_run=options.dry_run,
            stl=options.stl,
            clock=clock,
            stop=stops.judging,
        )
        record = run_record(loaded, packed, records, outputs)
        if options.dry_run:
            return replace(record, stages=clock.times)
        record = write_reports(record, outputs, clock)
        outputs.publish()
        return record
