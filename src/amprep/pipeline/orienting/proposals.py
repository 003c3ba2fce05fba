"""Search the orientations of a part by the settings of its job."""

import numpy as np

from amprep.job import Job
from amprep.job.settings.packing import Effort
from amprep.measures.printer_fit import which_fit
from amprep.model import Part, Progress, Stop
from amprep.model.orientation import OrientationRules
from amprep.orienting.search import FoundOrientations, OrientationSearch, Routed, propose_orientations

MEASURED: dict[Effort, int] = {"fast": 5, "normal": 10, "thorough": 20}
"""Level of effort -> number of orientations of a part that are measured exactly."""


def oriented(
    part: Part,
    job: Job,
    restricted: OrientationRules,
    effort: Effort,
    stop: Stop,
    progress: Progress,
    routed: Routed | None = None,
) -> FoundOrientations:
    """Return the orientations that are proposed for a part of a job.

    Parameters
    ----------
    part, job
        The part, and the job with printer, distances and rules.
    restricted
        What restricts its orientation.
    effort
        How many orientations are measured.
    stop
        Ends the search early.
    progress
        Called with the fraction that is done and a message.
    routed
        Plans the supports of the part in an orientation; None to leave it out.
    """
    packing, space = job.packing, job.printer.space
    outer = np.asarray(part.mesh.vertices)
    settings = OrientationSearch(
        measured=MEASURED[effort],
        fits=lambda rotations: which_fit(outer, rotations, space, packing.clearance_mm, packing.lift_mm),
        routed=routed,
    )
    return propose_orientations(
        part, job.supports, packing.lift_mm, restricted, settings, stop=stop, progress=progress
    )
