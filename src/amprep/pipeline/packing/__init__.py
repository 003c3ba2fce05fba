"""Pack parts: compute bounding volumes, call the packer, and place the parts in builds."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count

import numpy as np

from amprep.errors import AmprepError
from amprep.hookspecs import PackerAccepts
from amprep.job import Job, PackingSettings
from amprep.measures.bounding_volume import is_part_itself
from amprep.model import (
    BuildVolume,
    Item,
    Orientations,
    Packing,
    PackingProblem,
    Part,
    PlacedPart,
    Placement,
    Progress,
    Stop,
    SupportBody,
    TurnedVolume,
)
from amprep.model.summary import Summarised
from amprep.overhangs.known import KnownOverhangs
from amprep.pipeline.orienting.rotations import with_orientations
from amprep.pipeline.packing.adjusting import adjusted
from amprep.pipeline.packing.bounding import bound_parts, offered_orientations
from amprep.pipeline.packing.judging import refuse_wrong_packing
from amprep.pipeline.packing.parts import bound_for_parts
from amprep.pipeline.packing.placing import placed_part
from amprep.pipeline.packing.reserve import find_reserves, has_room, is_as_good, room_notes, with_room
from amprep.pipeline.packing.turning import turned_off_blade
from amprep.pipeline.reading import LoadedParts
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock
from amprep.pipeline.unit_question import unit_question


@dataclass(frozen=True, eq=False, repr=False)
class PackedBuild(Summarised):
    """The parts of one build, each in its place.

    Attributes
    ----------
    resolved
        The job with the offers that it names.
    number
        Number of the build, from 1; it also seeds the random numbers of the support router.
    build_id
        Name of the build in its file, for example ``bracket.build-1``.
    overhangs
        Overhangs of parts that packing found; None where there was no packing.
    kept
        Supports of other parts that exist already; new ones keep out of them.
    """

    resolved: ResolvedJob
    number: int
    build_id: str
    parts: tuple[PlacedPart, ...]
    overhangs: KnownOverhangs | None = None
    kept: tuple[SupportBody, ...] = ()

    def __str__(self) -> str:
        """Summary in one line."""
        return f"{self.build_id}: {', '.join(placed.label for placed in self.parts)}"


@dataclass(frozen=True, eq=False, repr=False)
class PackedParts(Summarised):
    """Result of packing: the builds, and the parts that are in none of them.

    Attributes
    ----------
    problem, packing
        The packing problem, and the packer's answer.
    builds
        Builds of placed parts; copies are in the order of the job.
    notes
        What was changed after the packer's answer, one sentence each.
    parts_bound
        Bound on the objective for any packing of the parts themselves; None if it is not known.
    """

    problem: PackingProblem
    packing: Packing
    builds: tuple[PackedBuild, ...]
    notes: tuple[str, ...] = ()
    parts_bound: float | None = None

    def __str__(self) -> str:
        """Return one line per build, and one for the unplaced items."""
        lines = [str(build) for build in self.builds]
        unplaced = len(self.packing.unplaced)
        return "\n".join([*lines, *([f"unplaced: {unplaced}"] if unplaced else [])])


def pack_parts(loaded: LoadedParts, clock: Clock, stop: Stop) -> PackedParts:
    """Bound the parts and pack them as the job says.

    Parameters
    ----------
    loaded
        Parts with their job.
    clock
        Times and shows the stages ``orient`` (if a part asks for it), ``bound`` and ``pack``.
    stop
        Ends both stages early; the packer then returns its best packing so far.

    Raises
    ------
    PluginError
        When a plugin fails, or the packer cannot handle the problem.
    AmprepError
        When nothing fits the build volume.
    """
    loaded, oriented = with_orientations(loaded, clock, stop)
    resolved, job = loaded.resolved, loaded.resolved.job
    accepts = resolved.packer.listed.offer.accepts
    with clock.stage("bound") as progress:
        loaded, turned = turned_off_blade(loaded, accepts)
        volumes, parts = bound_parts(loaded, stop, progress), loaded.parts
    with clock.stage("pack") as progress:
        problem = packing_problem(parts, volumes, job.printer.space, job.packing, accepts)
        resolved.host.refuse_mismatch(resolved.packer.listed, problem)
        packing, notes = _pack(resolved, problem, parts, stop, progress)
        overhangs = KnownOverhangs(job.supports)
        reserves = find_reserves(parts, problem, packing, job, overhangs, stop)
        if reserves:
            changed, wider = with_room(parts, problem, reserves)
            again, adjustments = packing, notes
            if not has_room(wider, packing):
                again, adjustments = _pack(resolved, wider, parts, stop, progress)
            kept = is_as_good(again, packing)
            if kept:
                parts, problem, packing, notes = changed, wider, again, adjustments
            notes += room_notes(parts, reserves, kept=kept)
        known = bound_for_parts(parts, problem, packing)
    builds = (
        PackedBuild(resolved, number, f"{job.name}.build-{number}", placed, overhangs)
        for number, placed in enumerate(placed_builds(parts, problem, packing), start=1)
    )
    return PackedParts(problem, packing, tuple(builds), (*oriented, *turned, *notes), known)


def _pack(
    resolved: ResolvedJob, problem: PackingProblem, parts: Sequence[Part], stop: Stop, progress: Progress
) -> tuple[Packing, tuple[str, ...]]:
    """Return the answer of the packer, adjusted as the job asks for, and notes on the adjustments."""
    job = resolved.job
    packing: Packing = resolved.packer.call(
        problem,
        rng=np.random.default_rng(job.seed),
        stop=packing_stop(stop, job),
        progress=progress,
    )
    refuse_wrong_packing(resolved.packer, problem, packing)
    return adjusted(problem, packing, parts, job.packing, stop)


def packing_stop(stop: Stop, job: Job) -> Stop:
    """Return the stop of the packer: with its own time limit, else half of the time if supports follow."""
    if job.packing.time_limit_s is None and stop.deadline is not None and job.supports.enabled:
        return stop.within(stop.remaining() / 2.0)
    return stop.within(job.packing.time_limit_s)


def packing_problem(
    parts: Sequence[Part],
    volumes: Sequence[TurnedVolume],
    space: BuildVolume,
    settings: PackingSettings,
    accepts: PackerAccepts,
) -> PackingProblem:
    """Return the problem with one item for every copy of every part, in the order of the job.

    Parameters
    ----------
    parts
        Parts with their quantities; copies with a fixed position stay there, in the first build.
    volumes
        Bounding volume of each part.
    space
        Build volume of the printer.
    settings
        Packing settings of the job.
    accepts
        Problems that the packer can handle; the items are offered those orientations that it can handle.
    """
    items = tuple(
        Item(index, copy, made.volume, part.fill_value, offered, made.rotation, exact)
        for index, (part, made) in enumerate(zip(parts, volumes, strict=True))
        for offered in (offered_orientations(part.orientations, made.rotation, accepts),)
        for exact in (_is_exact(part, made, offered),)
        for copy in range(part.quantity)
    )
    fixed = tuple(
        Placement(number, item.turn.T, part.fixed[item.copy] - part.mesh.vertices.min(axis=0))
        for number, item in enumerate(items)
        if (part := parts[item.part]).fixed is not None and item.copy < len(part.fixed)
    )
    return PackingProblem(
        items,
        space,
        settings.objective,
        fixed=fixed,
        clearance=settings.clearance_mm,
        lift=settings.lift_mm,
        stacking=settings.stacking,
        interlocking=settings.interlocking,
    )


def _is_exact(part: Part, made: TurnedVolume, offered: Orientations) -> bool:
    """Return whether the packer gets the part itself, in all orientations that the part allows."""
    return offered.freedom == part.orientations.freedom and is_part_itself(made.volume, part)


def labels(parts: Sequence[Part]) -> dict[tuple[int, int], str]:
    """Return a unique label for every copy ``(part, copy)``: ``bracket``, ``bracket-2``, ..."""
    taken = {part.name for part in parts}
    found: dict[tuple[int, int], str] = {}
    for index, part in enumerate(parts):
        found[index, 0] = part.name
        numbers = count(2)
        for copy in range(1, part.quantity):
            label = next(name for n in numbers if (name := f"{part.name}-{n}") not in taken)
            taken.add(label)
            found[index, copy] = label
    return found


def _nothing_placed(parts: Sequence[Part], problem: PackingProblem, packing: Packing) -> str:
    """Return a message that no part was placed, with the reasons and what to do."""
    found = sorted({parts[problem.items[entry.item].part].name for entry in packing.unplaced})
    names = f"{', '.join(found[:5])}{', ...' if len(found) > 5 else ''}"
    reasons = sorted({entry.reason for entry in packing.unplaced})
    if "out of time" in reasons:
        return f"the packer was stopped before it placed a part ({names}); give it more time or choose a faster packer"
    size = " x ".join(f"{value:g}" for value in problem.space.size)
    advice = "choose a larger printer, less clearance or lift, or allow rotations"
    for part in parts:
        question = unit_question(part, 0.0, float(problem.space.size.max()))
        if question:
            advice = f"{part.name}: {question}"
            break
    return f"none of the parts fits the build volume of {size} mm ({', '.join(reasons)}: {names}); {advice}"


def placed_builds(
    parts: Sequence[Part], problem: PackingProblem, packing: Packing
) -> list[tuple[PlacedPart, ...]]:
    """Return the placed parts of every build, in the order of the job, exactly where the file will store them.

    Raises
    ------
    AmprepError
        If nothing at all was placed.
    """
    if not packing.builds or not any(packing.builds):
        raise AmprepError(_nothing_placed(parts, problem, packing))
    names_of = labels(parts)

    def placed(placement: Placement) -> PlacedPart:
        item = problem.items[placement.item]
        return placed_part(names_of[item.part, item.copy], parts[item.part], item, placement)

    return [
        tuple(placed(each) for each in sorted(build, key=lambda each: each.item)) for build in packing.builds
    ]
