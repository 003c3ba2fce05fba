"""Supports one build: overhangs and grid, routing, cells, and what stays unsupported."""

from dataclasses import dataclass

import numpy as np

from amprep.checks.coverage import find_unsupported
from amprep.host import Host
from amprep.job import Job
from amprep.model import (
    Build,
    BuildSettings,
    PlacedPart,
    Report,
    Stop,
    SupportPlan,
    SupportProblem,
)
from amprep.pipeline.cell_file import choose_cell
from amprep.pipeline.cells import build_supports
from amprep.pipeline.stages import Clock
from amprep.pipeline.supports import SupportLayout, choose_pitch, plan_supports


@dataclass(frozen=True, eq=False)
class SupportedBuild:
    """A build with its supports, and the layout they came from (None when the job wants no supports)."""

    build: Build
    layout: SupportLayout | None = None


def support_build(
    job: Job,
    host: Host,
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
    pitch = job.supports.pitch_mm or choose_pitch(parts, job.printer.space, job.supports.strut_angle_deg)
    settings = build_settings(job, build_id, pitch)
    with clock.stage("route") as report:
        layout = _plan(job, host, parts, number, pitch, stop, report)
    with clock.stage("cells") as report:
        emitter = choose_cell(host, job)
        bodies = build_supports(
            layout,
            parts,
            lambda request: host.call(
                emitter, request, params=host.params(emitter, job.cells.params), stop=stop, report=report
            ),
            overlap=settings.overlap,
            connector=job.cells.connector,
            allow_surface=job.target == "generic",
            stop=stop,
            report=report,
        )
    with clock.stage("judge"):
        unsupported = find_unsupported(parts, bodies, settings, layout.reason_at)
    return SupportedBuild(Build(settings, parts, bodies, unsupported), layout)


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
        reach=job.supports.reach_mm or 1.5 * pitch,
        overhang_angle_deg=job.supports.overhang_angle_deg,
        strut_angle_deg=job.supports.strut_angle_deg,
        least_area=job.supports.least_area_mm2,
        least_length=job.supports.least_length_mm,
        supported=job.supports.enabled,
    )


def _plan(
    job: Job, host: Host, parts: tuple[PlacedPart, ...], number: int, pitch: float, stop: Stop, report: Report
) -> SupportLayout:
    wishes, angle = job.supports, job.supports.strut_angle_deg
    router, emitter = host.choose("router", wishes.strategy), choose_cell(host, job)
    params, stop = host.params(router, wishes.params), stop.within(wishes.time_limit_s)
    rng = np.random.default_rng([job.seed, number])

    def route(problem: SupportProblem, stop: Stop, report: Report) -> SupportPlan:
        return host.call(router, problem, params=params, rng=rng, stop=stop, report=report)

    return plan_supports(
        parts,
        job.printer.space,
        route=route,
        overhang_angle_deg=wishes.overhang_angle_deg,
        strut_angle_deg=angle,
        pitch=pitch,
        gap=wishes.gap_mm,
        edge_capacity=wishes.capacity,
        node_capacity=wishes.node_capacity,
        costs=(wishes.vertical_cost, wishes.oblique_cost),
        material=host.material(
            emitter, pitch, pitch * float(np.tan(np.radians(angle))), host.params(emitter, job.cells.params)
        ),
        least_area=wishes.least_area_mm2,
        least_length=wishes.least_length_mm,
        share_between_parts=wishes.share_between_parts,
        slender=wishes.slender if wishes.join_columns else None,
        stop=stop,
        report=report,
    )
