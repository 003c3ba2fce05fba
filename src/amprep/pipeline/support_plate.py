"""Support parts at the positions in their files: read, support, write, verify and report; nothing is packed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.errors import InputError
from amprep.model import BuildVolume, Orientations, Packing, Part, PlacedPart, Stop
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.packing import PackedBuild, labels, snapped
from amprep.pipeline.reading import LoadedParts, read_job
from amprep.pipeline.record import run_record
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.run import RunOptions, published
from amprep.pipeline.stages import Clock, Watcher
from amprep.pipeline.supporting import support_build
from amprep.pipeline.writing import finish_build
from amprep.report.record import RunRecord

_SUPPORTED_ANYWAY = "'amprep support' ignores supports.enabled = false (it applies to 'amprep run' only)"


def support_plate(
    resolved: ResolvedJob, options: RunOptions, *, center: bool = False, watcher: Watcher, stop: Stop
) -> RunRecord:
    """Support the parts of a job at the positions in their files, as one build, and return the record of the run.

    An interrupted run leaves no file.

    Parameters
    ----------
    resolved
        Job with the offers that it names; supports are planned even if the job has them disabled.
    options
        Output folder and other options.
    center
        Whether all parts together are first moved to the middle of the plate and onto it.
    watcher
        Shows the progress of every stage.
    stop
        Ends the run early.

    Raises
    ------
    AmprepError
        For wrong input, a plugin that fails, or a part outside the build volume.
    """
    clock, limit = Clock(watcher), stop.within(options.time_limit)
    loaded = read_job(resolved, clock, allow_surface=options.allow_surface)
    placed = place_as_read(loaded, center=center)
    parts = [_once_each(part) for part in loaded.parts]
    with OutputFolder(options.folder, placed.build_id, numbered=False) as outputs:
        supported = support_build(placed, clock, limit)
        build = finish_build(supported, 1, outputs, options.dry_run, options.stl, clock, stop)
        not_packed = Packing((), stop_reason="as it lies")
        record = run_record(placed.resolved.job, resolved.host, parts, [build], outputs, not_packed)
        if not resolved.job.supports.enabled:
            record = replace(record, notes=(*record.notes, _SUPPORTED_ANYWAY))
        return published(record, outputs, options, clock)


def place_as_read(loaded: LoadedParts, *, center: bool = False) -> PackedBuild:
    """Return one build with every part at each position in its file.

    Its job has supports enabled. Clearance and lift are zero, because the user chose the positions.

    Parameters
    ----------
    loaded
        Parts with their job.
    center
        Whether all parts together are moved to the middle of the plate and onto it.

    Raises
    ------
    InputError
        When a part is outside the build volume.
    """
    job = loaded.resolved.job
    job = replace(
        job,
        packing=replace(job.packing, clearance_mm=0.0, lift_mm=0.0),
        supports=replace(job.supports, enabled=True),
    )
    parts = placed_as_they_lie(loaded.parts, job.printer.space, center=center)
    return PackedBuild(replace(loaded.resolved, job=job), 1, f"{job.name}.supported", parts)


def placed_as_they_lie(
    parts: Sequence[Part], space: BuildVolume, *, center: bool = False
) -> tuple[PlacedPart, ...]:
    """Return every part, unrotated, at each position in its file; a part without positions stays at its origin.

    Raises
    ------
    InputError
        When a part is outside the build volume or below the plate.
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
    """Return the part with one copy per position in its file, and a note if its quantity differs."""
    count = len(_positions(part))
    if part.quantity == count:
        return part
    note = f"supported {count} times, once per build item; quantity = {part.quantity} only applies to packing"
    return replace(part, quantity=count, notes=(*part.notes, note))


def _positions(part: Part) -> Floats:
    return np.zeros((1, 3)) if part.positions is None else part.positions


def _moved(position: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = position
    return snapped(matrix)


def _to_middle(parts: Sequence[Part], space: BuildVolume) -> Floats:
    """Return the translation that moves the bounding box of all parts to the middle of the plate and onto it."""
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
        f"{placed.label} reaches from ({low}) to ({high}) mm, outside the build volume of {size} mm; {advice}, or let "
        "'amprep run' pack it"
    )
