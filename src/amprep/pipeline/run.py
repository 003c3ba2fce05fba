"""The main job: read, bound, pack, support, fill with cells, write, verify, report."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from amprep.hookspecs import Packer
from amprep.host import Host, Listed
from amprep.job import Job, apply_part_settings
from amprep.model import BoundingVolume, Packing, PackingProblem, Part, Progress, Stop
from amprep.pipeline.choose_cell import ChosenCell, choose_cell
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.packing import make_volumes, packing_problem, placed_builds
from amprep.pipeline.reading import expand_inputs, read_all, with_region_files
from amprep.pipeline.record import run_record, unplaced_records
from amprep.pipeline.stages import Clock, Watcher
from amprep.pipeline.supporting import support_build
from amprep.pipeline.writing import finish_build, write_reports
from amprep.report.record import RunRecord


@dataclass(frozen=True)
class RunOptions:
    """What the command line decides and a job file does not.

    Attributes
    ----------
    folder
        Where the outputs go.
    stl
        Whether parts and supports are written as STL too, in build coordinates.
    allow_surface
        Whether meshes that are no solids are packed and supported as they are.
    time_limit
        Seconds after which packing and routing end with their best answer so far.
    """

    folder: Path
    dry_run: bool = False
    stl: bool = False
    allow_surface: bool = False
    time_limit: float | None = None


def run(job: Job, host: Host, options: RunOptions, *, watcher: Watcher, stop: Stop) -> RunRecord:
    """Prepare every build of `job` and return what was done.

    Every stage is timed and shown by `watcher`. All files appear together at the end, so an interrupted run
    leaves none.

    Raises
    ------
    AmprepError
        For wrong input, an unknown or failing plugin, or when nothing fits the build volume.
    """
    clock, limit = Clock(watcher), stop.within(options.time_limit)
    cell = check_choices(job, host)
    with clock.stage("read") as progress:
        parts = read_job(job, host, options.allow_surface, progress)
    with clock.stage("bound") as progress:
        volumes = make_volumes(parts, lambda part: _volume(job, host, part, limit), progress)
    with clock.stage("pack") as progress:
        problem, packing = _pack(job, host, parts, volumes, limit, progress)
    placed = placed_builds(parts, problem, packing)
    with OutputFolder(options.folder, job.name) as outputs:
        supported = [
            support_build(job, host, cell, build, number, clock, limit, build_id=f"{job.name}.build-{number}")
            for number, build in enumerate(placed, start=1)
        ]
        records = [
            finish_build(each, number, outputs, options.dry_run, options.stl, clock, stop)
            for number, each in enumerate(supported, start=1)
        ]
        unplaced = unplaced_records(parts, problem, packing)
        return published(
            run_record(job, host, parts, records, outputs, packing, unplaced), outputs, options, clock
        )


def published(record: RunRecord, outputs: OutputFolder, options: RunOptions, clock: Clock) -> RunRecord:
    """Write the reports and let all files appear, unless this is a dry run; return the complete record."""
    if options.dry_run:
        return replace(record, stages=clock.times)
    record = write_reports(record, outputs, clock)
    outputs.publish()
    return record


def check_choices(job: Job, host: Host) -> ChosenCell:
    """Raise for an unknown strategy or parameter before anything long begins; return the lattice cell of the run."""
    chosen = (
        (host.choose("packer", job.packing.strategy), job.packing.params),
        (host.choose("router", job.supports.strategy), job.supports.params),
        (host.choose("volume", job.packing.volumes), job.packing.volume_params),
    )
    for listed, params in chosen:
        host.params(listed, params)
    return choose_cell(host, job)


def read_job(job: Job, host: Host, allow_surface: bool, progress: Progress) -> list[Part]:
    """Read everything the job names, and apply what it says of single parts."""
    files = expand_inputs([(entry.path, entry.quantity) for entry in job.inputs], host.suffixes)

    def read(path: Path) -> list[Part]:
        listed = host.reader_for(path, job.reading.readers)
        return host.call(
            listed, path, params=host.params(listed, job.reading.params.get(listed.offer.name, {}))
        )

    parts = read_all(files, read, allow_surface=allow_surface, progress=progress)
    return with_region_files(apply_part_settings(parts, job), job, read)


def _volume(job: Job, host: Host, part: Part, stop: Stop) -> BoundingVolume:
    """Bound a part: by the boxes given by hand, if there are any, whatever the job's strategy."""
    listed = host.choose("volume", "boxes" if part.boxes is not None else job.packing.volumes)
    params = host.params(listed, job.packing.volume_params if part.boxes is None else {})
    return host.call(listed, part, params=params, rng=np.random.default_rng(job.seed), stop=stop)


def _pack(
    job: Job, host: Host, parts: list[Part], volumes: list[BoundingVolume], stop: Stop, progress: Progress
) -> tuple[PackingProblem, Packing]:
    listed: Listed[Packer] = host.choose("packer", job.packing.strategy)
    problem = packing_problem(
        parts,
        volumes,
        job.printer.space,
        objective=job.packing.objective,
        clearance=job.packing.clearance_mm,
        lift=job.packing.lift_mm,
        stacking=job.packing.stacking,
    )
    host.refuse_mismatch(listed, problem)
    packing = host.call(
        listed,
        problem,
        params=host.params(listed, job.packing.params),
        rng=np.random.default_rng(job.seed),
        stop=stop.within(job.packing.time_limit_s),
        progress=progress,
    )
    return problem, packing
