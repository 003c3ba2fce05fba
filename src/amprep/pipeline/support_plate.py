"""Supports a plate as it lies: read, plan supports, fill with cells, write, verify, report; nothing is packed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.errors import InputError
from amprep.host import Host
from amprep.job import Job
from amprep.model import BuildVolume, Orientations, Packing, Part, PlacedPart, Stop
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.packing import labels, snapped
from amprep.pipeline.record import run_record
from amprep.pipeline.run import RunOptions, check_choices, published, read_job
from amprep.pipeline.stages import Clock, Watcher
from amprep.pipeline.supporting import support_build
from amprep.pipeline.writing import finish_build
from amprep.report.record import RunRecord

_DESPITE = "supports.enabled = false holds for 'amprep run'; 'amprep support' plans supports all the same"


def support(
    job: Job, host: Host, options: RunOptions, *, center: bool = False, watcher: Watcher, stop: Stop
) -> RunRecord:
    """Support the parts of `job` where their files put them, as one build, and return what was done.

    It plans supports even if the job has none for `amprep.pipeline.run.run`; then a note says so. Clearance and
    lift are not judged: how the parts lie is the user's choice. An interrupted run leaves no file.

    Parameters
    ----------
    center
        Whether everything is first moved, together, to the middle of the plate and down onto it.

    Raises
    ------
    AmprepError
        For wrong input, an unknown or failing plugin, or parts that reach out of the build volume.
    """
    notes = () if job.supports.enabled else (_DESPITE,)
    job = replace(
        job,
        packing=replace(job.packing, clearance_mm=0.0, lift_mm=0.0),
        supports=replace(job.supports, enabled=True),
    )
    clock, limit = Clock(watcher), stop.within(options.time_limit)
    cell = check_choices(job, host)
    with clock.stage("read") as progress:
        parts = [_once_each(part) for part in read_job(job, host, options.allow_surface, progress)]
    placed = placed_as_they_lie(parts, job.printer.space, center=center)
    name = f"{job.name}.supported"
    with OutputFolder(options.folder, name, numbered=False) as outputs:
        supported = support_build(job, host, cell, placed, 1, clock, limit, build_id=name)
        build = finish_build(supported, 1, outputs, options.dry_run, options.stl, clock, stop)
        as_it_lies = Packing((), stop_reason="as it lies")
        record = run_record(job, host, parts, [build], outputs, as_it_lies)
        record = replace(record, notes=(*record.notes, *notes))
        return published(record, outputs, options, clock)


def placed_as_they_lie(
    parts: Sequence[Part], space: BuildVolume, *, center: bool = False
) -> tuple[PlacedPart, ...]:
    """Return every part at each position its file gives it, turned no further; without any, where its mesh is.

    Raises
    ------
    InputError
        If a part reaches out of the build volume or below the plate.
    """
    lying = [_once_each(part) for part in parts]
    shift = _to_middle(lying, space) if center else np.zeros(3)
    names = labels(lying)
    placed = tuple(
        PlacedPart(names[index, copy], part, _moved(position + shift), Orientations())
        for index, part in enumerate(lying)
        for copy, position in enumerate(_positions(part))
    )
    for each in placed:
        _require_inside(each, space, center)
    return placed


def _once_each(part: Part) -> Part:
    """Return the part as often as it lies somewhere; a quantity that says otherwise is left out with a note."""
    count = len(_positions(part))
    if part.quantity == count:
        return part
    words = f"supported {count} times, as often as it lies on the plate; its quantity of {part.quantity} is for packing"
    return replace(part, quantity=count, notes=(*part.notes, words))


def _positions(part: Part) -> Floats:
    return np.zeros((1, 3)) if part.positions is None else part.positions


def _moved(position: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = position
    return snapped(matrix)


def _to_middle(parts: Sequence[Part], space: BuildVolume) -> Floats:
    """Return the move that brings the box around all parts to the middle of the plate, standing on it."""
    corners = [
        bound + position for part in parts for bound in part.mesh.bounds for position in _positions(part)
    ]
    lo, hi = np.min(corners, axis=0), np.max(corners, axis=0)
    middle = space.size / 2 - (lo + hi) / 2
    return np.array([middle[0], middle[1], -lo[2]])


def _require_inside(placed: PlacedPart, space: BuildVolume, centered: bool) -> None:
    lo, hi = placed.mesh.bounds
    within = (lo >= -TOLERANCE).all() and (hi <= space.size + TOLERANCE).all()
    if space.shape == "cylinder":
        radius = space.size[0] / 2
        within &= np.hypot(*(placed.mesh.vertices[:, :2] - radius).T).max() <= radius + TOLERANCE
    if within:
        return
    size = " x ".join(f"{value:g}" for value in space.size)
    low, high = (", ".join(f"{value:.6g}" for value in corner) for corner in (lo, hi))
    advice = "choose a larger --printer" if centered else "move it with --center, choose another --printer"
    raise InputError(
        f"{placed.label} lies from ({low}) to ({high}) mm, outside the build volume of {size} mm; {advice}, or let "
        "'amprep run' pack it"
    )
