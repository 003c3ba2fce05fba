"""Support one build: plan the supports, replace their edges by cells, and list the unsupported regions."""

from amprep.model import Stop
from amprep.pipeline.packing import PackedBuild
from amprep.pipeline.stages import Clock
from amprep.pipeline.supporting.emitting import emit_supports
from amprep.pipeline.supporting.figures import part_densities, removal_of
from amprep.pipeline.supporting.planning import pitch_of, plan_build
from amprep.pipeline.supporting.records import PlannedBuild, SupportedBuild
from amprep.pipeline.supporting.settings import build_settings, plate_origin, usual_reach

__all__ = [
    "PlannedBuild",
    "SupportedBuild",
    "build_settings",
    "emit_supports",
    "part_densities",
    "pitch_of",
    "plan_build",
    "plate_origin",
    "removal_of",
    "support_build",
    "usual_reach",
]


def support_build(
    build: PackedBuild, clock: Clock, stop: Stop, building: Stop | None = None
) -> SupportedBuild:
    """Plan and emit supports; what is not finished before the deadline of `building` is left out."""
    building = Stop(cancelled=stop.cancelled) if building is None else building
    return emit_supports(plan_build(build, clock, stop), clock, building)
