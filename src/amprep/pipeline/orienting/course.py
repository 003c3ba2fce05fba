"""Propose orientations for every part of a job, as ``amprep orient`` does."""

from dataclasses import dataclass, field, replace
from pathlib import Path

from amprep import __version__
from amprep.job.settings.packing import Effort
from amprep.model import Progress, Stop
from amprep.model.orientation import OrientationRules
from amprep.pipeline.orienting.outputs import write_orientations
from amprep.pipeline.orienting.proposals import oriented
from amprep.pipeline.orienting.routed import routed_by
from amprep.pipeline.reading import read_job, warnings_about
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock, Watcher
from amprep.report.orientation.record import OrientationRecord, OrientedPart


@dataclass(frozen=True)
class OrientOptions:
    """Options of a search for orientations that a job file does not have.

    Attributes
    ----------
    folder
        Folder for page, pictures and report; None to write nothing.
    effort
        How many orientations are measured; with ``thorough`` supports are planned for those that are proposed.
    restricted
        What restricts the orientation of every part.
    time_limit
        Seconds after which the search ends with its best results so far; None for no limit.
    """

    folder: Path | None = None
    effort: Effort = "normal"
    restricted: OrientationRules = field(default_factory=OrientationRules)
    time_limit: float | None = None


def orient_job(
    resolved: ResolvedJob, options: OrientOptions, *, watcher: Watcher, stop: Stop
) -> OrientationRecord:
    """Propose orientations for every part of a job.

    Parameters
    ----------
    resolved
        Job with the offers that it names.
    options
        Effort, restrictions, folder and time limit.
    watcher
        Shows the progress of every stage.
    stop
        Ends the work early.

    Raises
    ------
    AmprepError
        For wrong input or settings, or when a part has no allowed orientation.
    """
    clock, limit, job = Clock(watcher), stop.within(options.time_limit), resolved.job
    loaded = read_job(resolved, clock, allow_surface=True)
    routed = routed_by(resolved, limit) if options.effort == "thorough" else None
    parts: list[OrientedPart] = []
    with clock.stage("orient") as progress:
        for number, part in enumerate(loaded.parts):
            shown = _share(progress, number, len(loaded.parts))
            restricted = _joined(part.orient, options.restricted)
            found = oriented(part, job, restricted, options.effort, limit, shown, routed)
            parts.append(OrientedPart(part, found.tried, found.drawn, found.proposals))
    record = OrientationRecord(
        name=job.name,
        version=__version__,
        printer=job.printer.name,
        material=job.material.name,
        lift_mm=job.packing.lift_mm,
        parts=tuple(parts),
        warnings=(*resolved.host.warnings, *warnings_about(loaded.parts)),
    )
    if options.folder is not None:
        with clock.stage("report") as progress:
            record = write_orientations(record, job, options.folder, progress)
    return replace(record, stages=clock.times)


def _joined(own: OrientationRules | None, more: OrientationRules) -> OrientationRules:
    """Return what restricts a part by its entry in the job and by the options of the search."""
    if own is None:
        return more
    return OrientationRules(
        (*own.no_contact, *more.no_contact),
        (*own.face_up, *more.face_up),
        (*own.face_down, *more.face_down),
        min(own.tilt_deg, more.tilt_deg),
    )


def _share(progress: Progress, number: int, count: int) -> Progress:
    """Return a progress callback for one of `count` parts."""
    return lambda fraction, message: progress((number + fraction) / count, message)
