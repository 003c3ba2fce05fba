"""The packer `auto`: a packing at once, a better one as long as there is time, an end when none can be."""

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.auto.builds import pack_builds
from amprep.plugins.packers.auto.fill import pack_fill
from amprep.plugins.packers.params import AutoParams


def pack_auto(
    problem: PackingProblem, *, params: AutoParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Pack by the sortings of `extreme-points`, then search until the bound is met or the budget is used.

    The first pass is always begun, so that a late stop still gives an answer.
    """
    pack = pack_fill if problem.objective == "fill" else pack_builds
    return pack(problem, params=params, rng=rng, stop=stop, progress=progress)
