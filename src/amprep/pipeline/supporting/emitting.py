"""Replace the edges of planned supports by cells, and list the unsupported regions."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from amprep.geometry.connectors.least_width import LeastSection
from amprep.job import Job
from amprep.model import (
    Build,
    BuildSettings,
    Progress,
    Stop,
    SupportBody,
    Unsupported,
)
from amprep.model.supports import EXCEPTED
from amprep.overhangs.unsupported import find_unsupported
from amprep.pipeline.advice import advice_for
from amprep.pipeline.passes import PlannedPass, TakenRegions
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock
from amprep.pipeline.supporting.figures import removal_of
from amprep.pipeline.supporting.planning import part_of
from amprep.pipeline.supporting.records import PlannedBuild, SupportedBuild
from amprep.pipeline.supporting.settings import build_settings
from amprep.supports.effort import within_means
from amprep.supports.legs.short_legs import BuiltSupports, without_long_legs
from amprep.supports.plan import SupportLayout
from amprep.supports.solids.build import SolidRules, Surroundings, build_supports
from amprep.supports.solids.thin_cells import wall_advice


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
    parts, resolved, copies = planned.parts, planned.build.resolved, planned.copies
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
            built = _built(planned, number, around, stop, part_of(progress, number, len(settings)))
            made = built.bodies
            bodies += [replace(body, reach=own.reach, sizes=own.sizes) for body in made] if number else made
            passes[number] = passes[number]._replace(layout=built.layout)
    planned = replace(planned, passes=tuple(passes))
    with clock.stage("judge"):
        unsupported = _unsupported(planned, taken, bodies, settings)
        build = Build(settings[0], parts, tuple(bodies), unsupported)
        removal = removal_of(job, build)
        advice = list(advice_for(job, build, planned.pitch_mm))
        if copies is not None:
            build, removal = copies.expand(build, removal)
    for each in planned.passes:
        advice += _wall_advice(resolved.for_rule(each.rules[0]), each)
    found = taken.overhangs if copies is None else copies.all_overhangs(taken.overhangs)
    told, rules = tuple(dict.fromkeys(advice)), frozenset(taken.used)
    return SupportedBuild(build, planned.layouts, found, told, removal, rules, copies)


def _built(
    planned: PlannedBuild, number: int, earlier: Sequence[SupportBody], stop: Stop, progress: Progress
) -> BuiltSupports:
    """Return the supports of one pass, whose bodies keep out of the bodies of earlier passes."""
    own, parts = planned.passes[number], planned.parts
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
    parts = planned.parts
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


def _wall_advice(resolved: ResolvedJob, own: PlannedPass) -> Iterator[str]:
    return wall_advice(resolved.job.cells.strategy, resolved.cell.emit, own.pitch_mm, resolved.job.supports)
