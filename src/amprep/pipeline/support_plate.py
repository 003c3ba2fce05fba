"""Support parts at the positions in their files: read, support, write, verify and report; nothing is packed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.errors import InputError
from amprep.model import BuildVolume, Orientations, Packing, PackingProblem, Part, PlacedPart, Stop
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.packing import PackedBuild, PackedParts, labels
from amprep.pipeline.reading import LoadedParts, read_job
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.run import RunOptions, make_builds
from amprep.pipeline.stages import Clock, SupportStops, Watcher
from amprep.report.record import RunRecord
from amprep.threemf.transforms import round_as_stored

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
    clock, stops = Clock(watcher), SupportStops.after(options.time_limit, stop)
    loaded = read_job(resolved, clock, allow_surface=options.allow_surface)
    placed = place_as_read(loaded, center=center)
    notes = () if resolved.job.supports.enabled else (_SUPPORTED_ANYWAY,)
    lying = LoadedParts(placed.resolved, tuple(_once_each(part) for part in loaded.parts), notes)
    not_packed = Packing((), stop_reason="as it lies")
    packed = PackedParts(PackingProblem((), resolved.job.printer.space), not_packed, (placed,))
    outputs = OutputFolder(options.folder, placed.build_id, numbered=False)
    return make_builds(lying, packed, outputs, options, clock, stops)


def place_as_read(loaded: LoadedParts, *, center: bool = False) -> PackedBuild:
    """Return one build with every part, unrotated, at each position in its file; the origin if it has none.

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
        When a part is outside the build volume or below the plate.
    """
    job = loaded.resolved.job
    job = replace(
        job,
        packing=replace(job.packing, clearance_mm=0.0, lift_mm=0.0),
        supports=replace(job.supports, enabled=True),
    )
    parts = [_once_each(part) for part in loaded.parts]
    shift = _to_middle(parts, job.printer.space) if center else np.zeros(3)
    names = labels(parts)
    placed = tuple(
        PlacedPart(names[index, copy], part, _moved(position + shift), Orientations())
        for index, part in enumerate(parts)
        for copy, position in enumerate(part.origins)
    )
    for each in placed:
        _require_inside(each, job.printer.space, center)
    return PackedBuild(replace(loaded.resolved, job=job), 1, f"{job.name}.supported", placed)


def _once_each(part: Part) -> Part:
    """Return the part with one copy per position in its file, and a note if its quantity differs."""
    count = len(part.origins)
    if part.quantity == count:
        return part
    note = f"supported {count} times, once per build item; quantity = {part.quantity} only applies to packing"
    return replace(part, quantity=count, notes=(*part.notes, note))


def _moved(position: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = position
    return round_as_stored(matrix)


def _to_middle(parts: Sequence[Part], space: BuildVolume) -> Floats:
    """Return the translation that moves the bounding box of all parts to the middle of the plate and onto it."""
    corners = [bound + position for part in parts for bound in part.mesh.bounds for position in part.origins]
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
