"""Supports one build: overhangs and grid, routing, cells, and what stays unsupported."""

from dataclasses import dataclass

import numpy as np

from amprep.checks.supports.coverage import find_unsupported
from amprep.host import Host
from amprep.job import Job
from amprep.measures.removability import Removal, RemovalRules, measure_removal
from amprep.model import (
    Build,
    BuildSettings,
    PlacedPart,
    Progress,
    Stop,
    SupportPlan,
    SupportProblem,
)
from amprep.pipeline.advice import advice_for
from amprep.pipeline.choose_cell import ChosenCell
from amprep.pipeline.stages import Clock
from amprep.supports.plan import SupportLayout, Wishes, choose_pitch, plan_supports
from amprep.supports.solids.build import build_supports

LARGEST_REACH = 5.0
"""mm; however coarse the grid, no face that is farther from a contact counts as held, unless the job says so."""


@dataclass(frozen=True, eq=False)
class SupportedBuild:
    """A build with its supports, the layout they came from (None when the job wants none), and advice."""

    build: Build
    layout: SupportLayout | None = None
    advice: tuple[str, ...] = ()
    removal: tuple[Removal, ...] = ()


def support_build(
    job: Job,
    host: Host,
    cell: ChosenCell,
    parts: tuple[PlacedPart, ...],
    number: int,
    clock: Clock,
    stop: Stop,
    *,
    build_id: str,
) -> SupportedBuild:
    """Return build `number` with supports for everything that needs some, or listed with its reason."""
    if not job.supports.enabled:
        return SupportedBuild(Build(build_settings(job, build_id, pitch=1.0), parts))
    wishes = job.supports
    pitch = wishes.pitch_mm or choose_pitch(
        parts, job.printer.space, wishes.strut_angle_deg, wishes.memory_mb
    )
    settings = build_settings(job, build_id, pitch)
    with clock.stage("route") as progress:
        layout = _plan(job, host, cell, parts, number, pitch, stop, progress)
    with clock.stage("cells") as progress:
        bodies = build_supports(
            layout,
            parts,
            lambda request: cell.emit(request, stop=stop, progress=progress),
            overlap=settings.overlap,
            connector=job.cells,
            base=job.cells,
            allow_surface=job.target == "generic",
            beams=_beams(job),
            gap=settings.gap,
            space=job.printer.space,
            stop=stop,
            progress=progress,
        )
    with clock.stage("judge"):
        unsupported = find_unsupported(parts, bodies, settings, layout.reason_at)
    build = Build(settings, parts, bodies, unsupported)
    with clock.stage("judge"):
        removal = removal_of(job, build)
    return SupportedBuild(build, layout, tuple(advice_for(job, build, pitch)), removal)


def build_settings(job: Job, build_id: str, pitch: float) -> BuildSettings:
    """Return the rules that travel with the build's file."""
    return BuildSettings(
        build_id=build_id,
        space=job.printer.space,
        target=job.target,
        printer=job.printer.name,
        clearance=job.packing.clearance_mm,
        lift=job.packing.lift_mm,
        gap=job.supports.gap_mm,
        overlap=job.cells.overlap_mm,
        reach=job.supports.reach_mm or min(1.5 * pitch, LARGEST_REACH),
        overhang_angle_deg=job.supports.overhang_angle_deg,
        strut_angle_deg=job.supports.strut_angle_deg,
        least_area=job.supports.least_area_mm2,
        least_length=job.supports.least_length_mm,
        supported=job.supports.enabled,
        grounding=job.supports.grounding,
        supports_as=job.supports.write_as,
    )


def _beams(job: Job) -> bool | None:
    """Return whether the cell is to make beams, None to leave it to its parameters; slicers know none."""
    if job.target != "generic" or job.cells.lattice == "mesh":
        return False
    return True if job.cells.lattice == "beams" else None


def _plan(
    job: Job,
    host: Host,
    cell: ChosenCell,
    parts: tuple[PlacedPart, ...],
    number: int,
    pitch: float,
    stop: Stop,
    progress: Progress,
) -> SupportLayout:
    wishes, angle = job.supports, job.supports.strut_angle_deg
    router = host.choose("router", wishes.strategy)
    params, stop = host.params(router, wishes.params), stop.within(wishes.time_limit_s)
    rng = np.random.default_rng([job.seed, number])

    def route(problem: SupportProblem, stop: Stop, progress: Progress) -> SupportPlan:
        return host.call(router, problem, params=params, rng=rng, stop=stop, progress=progress)

    material = cell.material(pitch, pitch * float(np.tan(np.radians(angle))))
    return plan_supports(
        parts, job.printer.space, _wishes(job, pitch, material), route=route, stop=stop, progress=progress
    )


def _wishes(job: Job, pitch: float, material: tuple[float, float]) -> Wishes:
    asked = job.supports
    return Wishes(
        overhang_angle_deg=asked.overhang_angle_deg,
        strut_angle_deg=asked.strut_angle_deg,
        pitch=pitch,
        gap=asked.gap_mm,
        grounding=asked.grounding,
        memory_mb=asked.memory_mb,
        edge_capacity=asked.capacity,
        node_capacity=asked.node_capacity,
        escalation=asked.escalation,
        load_area=asked.load_area_mm2,
        load_height=asked.load_height_mm,
        costs=(asked.vertical_cost, asked.oblique_cost),
        material=material,
        least_area=asked.least_area_mm2,
        least_length=asked.least_length_mm,
        share_between_parts=asked.share_between_parts,
        slender=asked.slender if asked.join_columns else None,
    )


def removal_of(job: Job, build: Build) -> tuple[Removal, ...]:
    """Return the figures of each support body of `build`."""
    wishes = job.cells
    rules = RemovalRules(wishes.layer_mm, wishes.density_g_cm3, wishes.powder_hole_mm, wishes.removability)
    return measure_removal(build, rules)
