"""Inspect parts: what is in a file, what is wrong with it, where it fits, and its bounding volumes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from amprep import __version__
from amprep.model import Stop
from amprep.pipeline.inspecting.outputs import write_inspection
from amprep.pipeline.inspecting.parts import describe_part
from amprep.pipeline.inspecting.reading import read_for_inspection
from amprep.pipeline.inspecting.volumes import makers_named, measure_volumes, warm_up
from amprep.pipeline.reading import warnings_about
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock, Watcher
from amprep.report.inspection.record import InspectedPart, InspectionRecord


@dataclass(frozen=True)
class InspectOptions:
    """Options of an inspection that a job file does not have.

    Attributes
    ----------
    volumes
        Volume makers to try: ``all``, a name, or a chain ``A,B``.
    folder
        Folder for report, page and pictures; None to write nothing.
    time_limit
        Seconds after which volume makers end with their best result and no other one begins; None for no limit.
    """

    volumes: tuple[str, ...] = ()
    folder: Path | None = None
    time_limit: float | None = None


def inspect_job(
    resolved: ResolvedJob, options: InspectOptions, *, watcher: Watcher, stop: Stop
) -> InspectionRecord:
    """Inspect every part of a job.

    Parameters
    ----------
    resolved
        Job with the offers that it names; its printer is considered if the job names it, and else every known one.
    options
        Volume makers to try, output folder and time limit.
    watcher
        Shows the progress of every stage.
    stop
        Ends the work early.

    Raises
    ------
    AmprepError
        For wrong input or settings.
    """
    job, clock, limit = resolved.job, Clock(watcher), stop.within(options.time_limit)
    chains = makers_named(resolved, options.volumes)
    with clock.stage("read") as progress:
        files, read = read_for_inspection(resolved, progress)
    with clock.stage("inspect") as progress:
        found: list[InspectedPart] = []
        for number, (part, problem) in enumerate(read):
            progress(number / len(read), part.name)
            found.append(describe_part(part, problem, job))
    if chains:
        with clock.stage("volumes") as progress:
            warm_up(chains, job.seed)
            found = measure_volumes(found, chains, job.seed, limit, progress)
    record = InspectionRecord(
        name=job.name,
        version=__version__,
        files=tuple(files),
        parts=tuple(found),
        clearance_mm=job.packing.clearance_mm,
        lift_mm=job.packing.lift_mm,
        warnings=(*resolved.host.warnings, *warnings_about([part for part, _ in read])),
    )
    if options.folder is not None:
        with clock.stage("report") as progress:
            record = write_inspection(record, options.folder, progress)
    return replace(record, stages=clock.times)


__all__: Sequence[str] = ["InspectOptions", "inspect_job"]
