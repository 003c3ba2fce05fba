"""Support one build: plan the supports, replace their edges by cells, and list the unsupported regions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from amprep.job import Job
from amprep.measures.removability import Removal, RemovalRules, measure_removal
from amprep.model import (
    Build,
    BuildSettings,
    Progress,
    Stop,
)
from amprep.model.summary import Summarised
from amprep.model.supports.sizes import SupportSizes
from amprep.overhangs.of_part import PartOverhangs, overhangs_of
from amprep.overhangs.unsupported import find_unsupported
from amprep.pipeline.advice import advice_for
from amprep.pipeline.packing import PackedBuild
from amprep.pipeline.stages import Clock
from amprep.supports.grid.sizing import choose_pitch
from amprep.supports.plan import SupportLayout, plan_supports
from amprep.supports.solids.build import SolidRules, build_supports

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
    """

    build: Build
    layouts: tuple[SupportLayout, ...] = ()
    overhangs: tuple[PartOverhangs, ...] = ()
    advice: tuple[str, ...] = ()
    removal: tuple[Removal, ...] = ()

    def __str__(self) -> str:
        """Summary in one line."""
        build = self.build
        open_regions = sum(not region.minor for region in build.unsupported)
        return (
            f"{build.settings.build_id}: {len(build.parts)} parts, {len(build.supports)} supports, "
            f"{open_regions} unsupported regions"
        )


class PlannedPass(NamedTuple):
    """One pass of planning: some of the overhangs of a build, supported with the same settings.

    Attributes
    ----------
    pitch_mm
        Horizontal size of a voxel of the support grid.
    layout
        Layout of the supports.
    """

    pitch_mm: float
    layout: SupportLayout


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
    overhangs
        The overhangs of each part.
    """

    build: PackedBuild
    passes: tuple[PlannedPass, ...] = ()
    overhangs: tuple[PartOverhangs, ...] = ()

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


def support_build(build: PackedBuild, clock: Clock, stop: Stop) -> SupportedBuild:
    """Return a build with supports for all of its overhangs; overhangs without support are listed with a reason."""
    return emit_supports(plan_build(build, clock, stop), clock, stop)


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
    pitch = choose_pitch(build.parts, job.printer.space, job.supports)
    with clock.stage("route") as progress:
        overhangs = tuple(overhangs_of(placed, job.supports) for placed in build.parts)
        layout = _layout(build, overhangs, pitch, stop, progress)
    return PlannedBuild(build, (PlannedPass(pitch, layout),), overhangs)


def emit_supports(planned: PlannedBuild, clock: Clock, stop: Stop) -> SupportedBuild:
    """Replace the edges of planned supports by the cell of the job and list the unsupported regions.

    Parameters
    ----------
    planned
        Layout of the supports, with the placed parts and their job.
    clock
        Times and shows the stages ``cells`` and ``judge``.
    stop
        Ends the work early.

    Raises
    ------
    PluginError
        When the cell fails.
    """
    parts, layout, resolved = planned.build.parts, planned.layout, planned.build.resolved
    job = resolved.job
    settings = build_settings(job, planned.build.build_id, planned.pitch_mm)
    if layout is None:
        return SupportedBuild(Build(settings, parts))
    with clock.stage("cells") as progress:
        bodies = build_supports(
            layout,
            parts,
            lambda request: resolved.cell.emit(request, stop=stop, progress=progress),
            SolidRules(
                connector=job.cells,
                base=job.cells,
                overlap=settings.overlap,
                allow_surface=job.target == "generic",
                beams=job.beams,
                gap=job.supports.gap_mm,
                space=job.printer.space,
            ),
            stop=stop,
            progress=progress,
        )
    with clock.stage("judge"):
        unsupported = find_unsupported(parts, planned.overhangs, bodies, settings, layout.reason_at)
        build = Build(settings, parts, bodies, unsupported)
        removal = removal_of(job, build)
    advice = tuple(advice_for(job, build, planned.pitch_mm))
    return SupportedBuild(build, planned.layouts, planned.overhangs, advice, removal)


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
        reach=job.supports.reach_mm or min(1.5 * pitch, LARGEST_REACH),
        rules=job.supports,
        supported=job.supports.enabled,
        supports_as=job.supports.write_as,
        sizes=_sizes(job, pitch),
    )


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
    build: PackedBuild, overhangs: Sequence[PartOverhangs], pitch: float, stop: Stop, progress: Progress
) -> SupportLayout:
    job, resolved = build.resolved.job, build.resolved
    rules = replace(job.supports, pitch_mm=pitch)
    rng = np.random.default_rng([job.seed, build.number])
    material = resolved.cell.material(pitch, pitch * float(np.tan(np.radians(rules.strut_angle_deg))))
    return plan_supports(
        build.parts,
        job.printer.space,
        rules,
        overhangs=overhangs,
        material=material,
        route=lambda problem, stop, progress: resolved.router.call(
            problem, rng=rng, stop=stop, progress=progress
        ),
        stop=stop.within(rules.time_limit_s),
        progress=progress,
    )


def removal_of(job: Job, build: Build) -> tuple[Removal, ...]:
    """Return the figures of each support body of `build`."""
    cells = job.cells
    rules = RemovalRules(job.supports.layer_mm, cells.density_g_cm3, cells.powder_hole_mm, cells.removability)
    return measure_removal(build, rules)
