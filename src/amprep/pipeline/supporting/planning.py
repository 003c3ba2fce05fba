"""Plan the supports of a build on the support grid."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from amprep.model import (
    PlacedPart,
    Progress,
    Stop,
)
from amprep.overhangs.of_part import PartOverhangs
from amprep.pipeline.packing import PackedBuild
from amprep.pipeline.passes import PlannedPass, passes_of, plan_in_order, take_regions
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock
from amprep.pipeline.supporting.copies import find_equal_copies
from amprep.pipeline.supporting.records import PlannedBuild
from amprep.supports.grid.sizing import choose_pitch
from amprep.supports.legs.cell import CellProperties, measure_cell
from amprep.supports.plan import PassScope, SupportLayout, plan_supports
from amprep.supports.solids.thin_cells import suitable_pitch


def plan_build(build: PackedBuild, clock: Clock, stop: Stop) -> PlannedBuild:
    """Plan the supports of a build on the support grid; those of equal copies with nothing else near are planned once.

    Parameters
    ----------
    build
        Placed parts with their job.
    clock
        Times and shows the stage ``route``.
    stop
        Ends the routing early; the router then returns its best plan so far.

    Raises
    ------
    PluginError
        When the router or the cell fails.
    JobError
        When the support grid needs more memory than the job allows.
    """
    job = build.resolved.job
    if not job.supports.enabled:
        return PlannedBuild(build)
    with clock.stage("route") as progress:
        copies = find_equal_copies(build)
        parts = build.parts if copies is None else copies.planned_parts
        taken = take_regions(build.resolved, parts, build.overhangs)
        divided, excepted = passes_of(build.resolved, taken)

        def plan(number: int, earlier: Sequence[PlannedPass]) -> PlannedPass:
            each = divided[number]
            own = replace(build, resolved=each.resolved, parts=parts)
            pitch = pitch_of(each.resolved, build.parts)
            taking = taken.chosen(each.rules, excepted)
            shown = part_of(progress, number, len(divided))
            layout = _layout(own, taking, [done.layout for done in earlier], pitch, stop, shown)
            return PlannedPass(each.rules, pitch, layout)

        planned = plan_in_order(len(divided), plan)
    return PlannedBuild(build, planned, taken, copies)


def pitch_of(resolved: ResolvedJob, parts: Sequence[PlacedPart]) -> float:
    """Return the pitch (mm) that the job gives, or one that suits parts, memory and cell."""
    rules = resolved.job.supports
    pitch = choose_pitch(parts, resolved.job.printer.space, rules)
    return pitch if rules.pitch_mm is not None else suitable_pitch(resolved.cell.emit, pitch, rules)


def part_of(progress: Progress, number: int, count: int) -> Progress:
    """Return a progress callback for one of `count` equal steps of the work."""
    return lambda fraction, message: progress((number + fraction) / count, message)


def _layout(
    build: PackedBuild,
    overhangs: Sequence[PartOverhangs],
    earlier: Sequence[SupportLayout],
    pitch: float,
    stop: Stop,
    progress: Progress,
) -> SupportLayout:
    job, resolved = build.resolved.job, build.resolved
    rules = replace(job.supports, pitch_mm=pitch)
    rng = np.random.default_rng([job.seed, build.number])
    step = pitch * float(np.tan(np.radians(rules.strut_angle_deg)))
    return plan_supports(
        build.parts,
        job.printer.space,
        rules,
        cell=CellProperties(
            resolved.cell.material(pitch, step),
            measure_cell(resolved.cell.emit, pitch, step, rules) if rules.leg_ratio else None,
        ),
        scope=PassScope(overhangs, earlier=earlier, kept=[each.mesh for each in build.kept]),
        route=lambda problem, stop, progress: resolved.router.call(
            problem, rng=rng, stop=stop, progress=progress
        ),
        stop=stop.within(rules.time_limit_s),
        progress=progress,
    )
