"""Plan the supports of one part in an orientation, to compare orientations by what is built below them."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.measures.density import support_volume
from amprep.model import Part, PlacedPart, Stop
from amprep.orienting.measure import stood
from amprep.pipeline.packing import PackedBuild
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock, ProgressWatcher
from amprep.pipeline.supporting import pitch_of, support_build


def routed_by(resolved: ResolvedJob, stop: Stop) -> Callable[[Part, Floats], tuple[float, int]]:
    """Return a function that plans the supports of a part alone, in the middle of the plate.

    All orientations of a part are planned with the pitch that suits the part as drawn, so that their volumes can be
    compared. The function returns the volume of the solid supports (mm3), and the number of regions that stay
    unsupported, minor ones left out.

    Parameters
    ----------
    resolved
        Job with the offers that it names.
    stop
        Ends the planning early, with the best plan so far.
    """
    pitches: dict[int, float] = {}

    def routed(part: Part, rotation: Floats) -> tuple[float, int]:
        if id(part) not in pitches:
            pitches[id(part)] = pitch_of(resolved, [_in_the_middle(resolved, part, np.eye(3))])
        supports = replace(resolved.job.supports, enabled=True, pitch_mm=pitches[id(part)])
        own = replace(resolved, job=replace(resolved.job, supports=supports))
        build = PackedBuild(own, 1, part.name, (_in_the_middle(own, part, rotation),))
        built = support_build(build, Clock(ProgressWatcher()), stop).build
        return support_volume(built), sum(not each.minor for each in built.unsupported)

    return routed


def _in_the_middle(resolved: ResolvedJob, part: Part, rotation: Floats) -> PlacedPart:
    """Return the part in an orientation in the middle of the plate, at the lift of the job."""
    job = resolved.job
    placed = stood(part, rotation, job.packing.lift_mm)
    matrix = placed.matrix.copy()
    matrix[:2, 3] = (job.printer.space.size[:2] - placed.mesh.bounds[0][:2] - placed.mesh.bounds[1][:2]) / 2.0
    return replace(placed, matrix=matrix)
