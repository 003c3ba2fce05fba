"""Support one build: plan the supports, replace their edges by cells, and list the unsupported regions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from amprep.geometry.connectors.least_width import LeastSection
from amprep.job import Job
from amprep.job.planning import planning_table
from amprep.materials.catalogue import densities_of
from amprep.measures.removability import Removal, RemovalRules, measure_removal
from amprep.model import (
    Build,
    BuildSettings,
    PlacedPart,
    Progress,
    Stop,
    SupportBody,
    Target,
    Unsupported,
)
from amprep.model.summary import Summarised
from amprep.model.supports import EXCEPTED
from amprep.model.supports.sizes import SupportSizes
from amprep.overhangs.of_part import PartOverhangs
from amprep.overhangs.unsupported import find_unsupported
from amprep.pipeline.advice import advice_for
from amprep.pipeline.packing import PackedBuild
from amprep.pipeline.passes import PlannedPass, TakenRegions, passes_of, plan_in_order, take_regions
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock
from amprep.printers.catalogue import Printer
from amprep.supports.effort import within_means
from amprep.supports.grid.sizing import choose_pitch
from amprep.supports.legs.cell import CellProperties, measure_cell
from amprep.supports.legs.short_legs import BuiltSupports, without_long_legs
from amprep.supports.plan import PassScope, SupportLayout, plan_supports
from amprep.supports.solids.build import SolidRules, Surroundings, build_supports
from amprep.supports.solids.thin_cells import suitable_pitch, wall_advice

LARGEST_REACH = 5.0
"""Upper limit (mm) of the default reach: even in a coarse grid, no face farther from a contact counts as held."""


@dataclass(frozen=True, eq=False, repr=False)
class SupportedBuild(Summarised):
    """A build with its supports.

    Attributes
    ----------
    build
        Parts, supports, unsupported regions, and the rules they were made under.
    layouts
        Layouts of the supports, one for each pass of planning; empty when the job has no supports.
    overhangs
        The overhangs of each part; empty when the job has no supports.
    advice
        Settings to try where something stays unsupported, one sentence each.
    removal
        Figures on the removal of each support body.
    rules
        Numbers of the ``[[rule]]`` entries that take a region, from 1; 0 if one is left to the settings of the job.
    """

    build: Build
    layouts: tuple[SupportLayout, ...] = ()
    overhangs: tuple[PartOverhangs, ...] = ()
    advice: tuple[str, ...] = ()
    removal: tuple[Removal, ...] = ()
    rules: frozenset[int] = frozenset()

    def __str__(self) -> str:
        """Summary in one line."""
        build = self.build
        open_regions = sum(not region.minor for region in build.unsupported)
        return (
            f"{build.settings.build_id}: {len(build.parts)} parts, {len(build.supports)} supports, "
            f"{open_regions} unsupported regions"
        )


@dataclass(frozen=True, eq=False, repr=False)
class PlannedBuild(Summarised):
    """A build with the layout of its supports, before edges are replaced by cells.

    Attributes
    ----------
    build
        The placed parts with their job.
    passes
        The passes of planning, each with its settings and its layout; the first has the settings of the job. Empty
        when the job has no supports.
    taken
        The overhangs of the parts, and the rules that take them; None when the job has no supports.
    """

    build: PackedBuild
    passes: tuple[PlannedPass, ...] = ()
    taken: TakenRegions | None = None

    @property
    def layout(self) -> SupportLayout | None:
        """Layout of the first pass; None when the job has no supports."""
        return self.passes[0].layout if self.passes else None

    @property
    def layouts(self) -> tuple[SupportLayout, ...]:
        """Layouts of all passes."""
        return tuple(each.layout for each in self.passes)

    @property
    def pitch_mm(self) -> float:
        """Horizontal size of a voxel of the support grid of the first pass; 1 when the job has no supports."""
        return self.passes[0].pitch_mm if self.passes else 1.0

    def __str__(self) -> str:
        """Summary in one line."""
        if not self.passes:
            return f"{self.build.build_id}: no supports"
        connected = sum(int(layout.connected.sum()) for layout in self.layouts)
        pitches = ", ".join(f"{pitch:g}" for pitch in dict.fromkeys(each.pitch_mm for each in self.passes))
        return (
            f"{self.build.build_id}: {connected} of {sum(len(each.red.square) for each in self.layouts)} red squares "
            f"connected, pitch {pitches} mm"
        )


def support_build(
    build: PackedBuild, clock: Clock, stop: Stop, building: Stop | None = None
) -> SupportedBuild:
    """Plan and emit supports; what is not finished before the deadline of `building` is left out."""
    building = Stop(cancelled=stop.cancelled) if building is None else building
    return emit_supports(plan_build(build, clock, stop), clock, building)


def plan_build(build: PackedBuild, clock: Clock, stop: Stop) -> PlannedBuild:
    """Plan the supports of a build on the support grid.

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
        taken = take_regions(build.resolved, build.parts, build.overhangs)
        divided, excepted = passes_of(build.resolved, taken)

        def plan(number: int, earlier: Sequence[PlannedPass]) -> PlannedPass:
            each = divided[number]
            own = replace(build, resolved=each.resolved)
            pitch = pitch_of(each.resolved, build.parts)
            taking = taken.chosen(each.rules, excepted)
            shown = _part_of(progress, number, len(divided))
            layout = _layout(own, taking, [done.layout for done in earlier], pitch, stop, shown)
            return PlannedPass(each.rules, pitch, layout)

        planned = plan_in_order(len(divided), plan)
    return PlannedBuild(build, planned, taken)


def pitch_of(resolved: ResolvedJob, parts: Sequence[PlacedPart]) -> float:
    """Return the pitch (mm) that the job gives, or one that suits parts, memory and cell."""
    rules = resolved.job.supports
    pitch = choose_pitch(parts, resolved.job.printer.space, rules)
    return pitch if rules.pitch_mm is not None else suitable_pitch(resolved.cell.emit, pitch, rules)


def _part_of(progress: Progress, number: int, count: int) -> Progress:
    """Return a progress callback for one of `count` equal steps of the work."""
    return lambda fraction, message: progress((number + fraction) / count, message)


def emit_supports(planned: PlannedBuild, clock: Clock, stop: Stop) -> SupportedBuild:
    """Replace the edges of planned supports by the cell of the job and list the unsupported regions.

    Parameters
    ----------
    planned
        Layout of the supports, with the placed parts and their job.
    clock
        Times and shows the stages ``cells`` and ``judge``.
    stop
        Ends the work early: supports that cannot be finished before its deadline are left out.

    Raises
    ------
    PluginError
        When the cell fails.
    JobError
        When the supports need more memory than this machine has.
    """
    parts, resolved = planned.build.parts, planned.build.resolved
    job = resolved.job
    settings = [
        build_settings(resolved.for_rule(each.rules[0]).job, planned.build.build_id, each.pitch_mm)
        for each in planned.passes
    ]
    taken = planned.taken
    if taken is None:
        return SupportedBuild(Build(build_settings(job, planned.build.build_id, planned.pitch_mm), parts))
    bodies: list[SupportBody] = []
    passes = list(planned.passes)
    with clock.stage("cells") as progress:
        for number, own in enumerate(settings):
            around = (*planned.build.kept, *bodies)
            built = _built(planned, number, around, stop, _part_of(progress, number, len(settings)))
            made = built.bodies
            bodies += [replace(body, reach=own.reach, sizes=own.sizes) for body in made] if number else made
            passes[number] = passes[number]._replace(layout=built.layout)
    planned = replace(planned, passes=tuple(passes))
    with clock.stage("judge"):
        unsupported = _unsupported(planned, taken, bodies, settings)
        build = Build(settings[0], parts, tuple(bodies), unsupported)
        removal = removal_of(job, build)
    advice = [
        *advice_for(job, build, planned.pitch_mm),
        *(words for each in planned.passes for words in _wall_advice(resolved.for_rule(each.rules[0]), each)),
    ]
    found, rules = taken.overhangs, frozenset(taken.used)
    return SupportedBuild(build, planned.layouts, found, tuple(dict.fromkeys(advice)), removal, rules)


def _built(
    planned: PlannedBuild, number: int, earlier: Sequence[SupportBody], stop: Stop, progress: Progress
) -> BuiltSupports:
    """Return the supports of one pass, whose bodies keep out of the bodies of earlier passes."""
    own, parts = planned.passes[number], planned.build.parts
    resolved = planned.build.resolved.for_rule(own.rules[0])
    job = resolved.job
    rules = SolidRules(
        connector=job.cells,
        base=job.cells,
        overlap=job.cells.overlap_mm,
        allow_surface=job.target == "generic",
        beams=job.beams,
        gap=job.supports.gap_mm,
        space=job.printer.space,
        least=least_section(job),
        leg_ratio=job.supports.leg_ratio,
    )

    around = Surroundings(earlier, planned.layouts[number + 1 :])

    def build(layout: SupportLayout) -> tuple[SupportBody, ...]:
        return build_supports(
            layout,
            parts,
            lambda request: resolved.cell.emit(request, stop=stop, progress=progress),
            rules,
            around=around,
            stop=stop,
            progress=progress,
        )

    layout = within_means(own.layout, resolved.cell.emit, job.supports, stop)
    built = without_long_legs(build, layout, parts, rules.leg_ratio, stop)
    if number == 0:
        return built
    name = f"rule {own.rules[0]}"
    return built._replace(bodies=tuple(replace(body, name=f"{body.name}, {name}") for body in built.bodies))


def _unsupported(
    planned: PlannedBuild,
    taken: TakenRegions,
    bodies: Sequence[SupportBody],
    settings: Sequence[BuildSettings],
) -> tuple[Unsupported, ...]:
    """List the unsupported overhangs of every pass, and those that a rule excepts, which are no fault."""
    parts = planned.build.parts
    found: list[Unsupported] = []
    for each, rules in zip(planned.passes, settings, strict=True):
        layout = each.layout
        found += find_unsupported(parts, layout.overhangs, bodies, settings[0], layout.reason_at, rules.reach)
    excepted = [number for number, rule in enumerate(planned.build.resolved.job.rules, 1) if not rule.support]
    left = find_unsupported(
        parts, taken.chosen(excepted, ()), bodies, settings[0], lambda _, points: [EXCEPTED] * len(points)
    )
    return (*found, *(replace(each, minor=True) for each in left))


def least_section(job: Job) -> LeastSection | None:
    """Return the least section of connectors of a job, None where it has none."""
    rules = job.supports
    has_least = rules.least_wall_mm > 0.0 or rules.least_contact_mm2 > 0.0
    return LeastSection(rules.least_wall_mm, rules.least_contact_mm2) if has_least else None


def usual_reach(pitch: float, spacing: float) -> float:
    """Return the reach (mm) of a job that states none: 1.5 pitches, but no more than the contact spacing.

    Contacts at the corners of squares as wide as the spacing are 0.71 spacings from the middle. With the distance
    of sample points that is 0.8 spacings, below which the reach does not fall.
    """
    reach = min(1.5 * pitch, LARGEST_REACH)
    return max(min(reach, spacing), 0.8 * spacing) if spacing else reach


def build_settings(job: Job, build_id: str, pitch: float) -> BuildSettings:
    """Return the rules that travel with the build's file."""
    return BuildSettings(
        build_id=build_id,
        space=job.printer.space,
        target=job.target,
        printer=job.printer.name,
        clearance=job.packing.clearance_mm,
        lift=job.packing.lift_mm,
        overlap=job.cells.overlap_mm,
        reach=job.supports.reach_mm or usual_reach(pitch, job.supports.contact_spacing_mm),
        rules=job.supports,
        supported=job.supports.enabled,
        supports_as=job.supports.write_as,
        sizes=_sizes(job, pitch),
        plate_origin=plate_origin(job.printer, job.target),
        planning=planning_table(job),
    )


def plate_origin(printer: Printer, target: Target) -> tuple[float, float]:
    """Return where files for a target place the corner of the plate of a printer, x and y in mm.

    PrusaSlicer counts from the origin of the machine, other programs from the corner of the plate.
    """
    return printer.plate_origin if target == "prusaslicer" else (0.0, 0.0)


def _sizes(job: Job, pitch: float) -> SupportSizes:
    cells = job.cells
    tips, base = cells.has_tips, cells.base != "direct"
    return SupportSizes(
        square_mm=pitch,
        tip_width_mm=cells.tip_width_mm if tips else 0.0,
        tip_height_mm=cells.tip_height_mm if tips else 0.0,
        neck_mm=cells.neck_mm,
        base_margin_mm=cells.base_margin_mm if base else 0.0,
        base_height_mm=cells.base_height_mm if base else 0.0,
    )


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


def _wall_advice(resolved: ResolvedJob, own: PlannedPass) -> Iterator[str]:
    return wall_advice(resolved.job.cells.strategy, resolved.cell.emit, own.pitch_mm, resolved.job.supports)


def removal_of(job: Job, build: Build) -> tuple[Removal, ...]:
    """Return the figures of each support body of `build`."""
    cells, density = job.cells, job.cells.density_g_cm3
    densities = part_densities(job, build) if density is None else (density,) * len(build.parts)
    rules = RemovalRules(job.supports.layer_mm, densities, cells.powder_hole_mm, cells.removability)
    return measure_removal(build, rules)


def part_densities(job: Job, build: Build) -> tuple[float | None, ...]:
    """Return the density (g/cm3) of each part: that of its own material, or else that of the job's."""
    return densities_of([placed.part.appearance.material for placed in build.parts], job.material, job.folder)
