"""State what was ordered: the settings and parts of a job, or a printer, by which a build file is judged."""

from dataclasses import replace
from functools import reduce
from pathlib import Path

from amprep.checks.ordered.order import Order
from amprep.checks.ordered.weaker import most_lenient
from amprep.errors import JobError
from amprep.host import Host
from amprep.job import Job, job_from_inputs, override
from amprep.model import Build, BuildSettings
from amprep.model.supports.sizes import SupportSizes
from amprep.pipeline.reading import read_job
from amprep.pipeline.resolve import ResolvedJob, resolve
from amprep.pipeline.stages import Clock, Watcher
from amprep.pipeline.supporting import build_settings, pitch_of, plate_origin
from amprep.supports.grid.sizing import choose_pitch

_MOST_FOR_CELL = 2.0
"""Length (mm) by which the pitch of a file may be larger than usual because its cell needs it."""


def usual_settings(build: Build) -> BuildSettings:
    """Return the settings that a build with the same parts, printer and target has by default.

    A printer that is not in the catalogue counts as the default printer with the build volume of the file.
    """
    job = job_from_inputs(["part.stl"])
    try:
        job = override(job, {"printer": build.settings.printer or None})
    except JobError:
        job = override(job, {})
    printer = replace(job.printer, space=build.settings.space)
    job = replace(job, printer=printer, target=build.settings.target)
    pitch = choose_pitch(build.parts, printer.space, job.supports)
    of_cell = min(build.settings.sizes.square_mm, pitch + _MOST_FOR_CELL)  # cells with thick walls need more
    return build_settings(job, build.settings.build_id, max(pitch, of_cell))


def settings_for(resolved: ResolvedJob, build: Build) -> BuildSettings:
    """Return the settings that a job gives to a build with these placed parts.

    Reach and sizes are the largest of its passes.
    """
    passes = [
        build_settings(own.job, build.settings.build_id, pitch_of(own, build.parts))
        for own in (resolved.for_rule(number) for number in range(len(resolved.job.rules) + 1))
    ]
    sizes = reduce(SupportSizes.enlarged, (each.sizes for each in passes))
    origin = plate_origin(resolved.job.printer, build.settings.target)
    reach = max(each.reach for each in passes)
    return replace(passes[0], reach=reach, sizes=sizes, plate_origin=origin)


def order_of_printer(build: Build, printer: str) -> Order:
    """Return an order of a printer alone: the settings are those of the build, with the printer's build volume.

    Raises
    ------
    JobError
        When there is no such printer.
    """
    job = override(job_from_inputs(["part.stl"]), {"printer": printer})
    origin = plate_origin(job.printer, build.settings.target)
    settings = replace(
        most_lenient(build), space=job.printer.space, printer=job.printer.name, plate_origin=origin
    )
    return Order(job.printer.name, settings)


def order_of_job(
    build: Build, job: Job, host: Host, watcher: Watcher, *, allow_surface: bool = False
) -> Order:
    """Return the order of a job: its settings for a build with these placed parts, and its parts.

    Raises
    ------
    AmprepError
        When the job is wrong or its inputs cannot be read.
    """
    resolved = resolve(job, host)
    loaded = read_job(resolved, Clock(watcher), allow_surface=allow_surface)
    name = job.source if job.folder is None else Path(job.source).name
    return Order(name, settings_for(resolved, build), loaded.parts)
