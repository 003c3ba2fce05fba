"""The packer `sweep`: builds are sliced into layers, layers into rows, and rows packed along one axis."""

import numpy as np

from amprep.model.control import Report, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packing.params import SweepParams
from amprep.plugins.packing.rows import pack_rows, slicings
from amprep.plugins.packing.scene import prepare
from amprep.plugins.packing.solution import as_packing


def pack_sweep(
    problem: PackingProblem, *, params: SweepParams, rng: np.random.Generator, stop: Stop, report: Report
) -> Packing:
    """Pack by slicing builds along two axes, which leaves one-dimensional packing (Sweep 2003, thesis 2.1).

    Boxes come by decreasing height; each goes first fit into a row that is deep and high enough, else starts
    a row in the first layer that is high enough, else a layer in the first build with room, else a build. All
    choices of axes are tried (without stacking there is one layer, on the plate), and the best packing is
    kept. An item of several boxes takes the room of the box around it. No random numbers are drawn.
    """
    del rng
    scene = prepare(problem)
    chosen = list(slicings(scene, np.flatnonzero(scene.free)))[: params.slicings or None]
    best = pack_rows(scene, chosen[0])
    for number, slicing in enumerate(chosen[1:], start=1):
        if stop():
            return as_packing(scene, best, stop.reason)
        report(number / len(chosen), "trying slicings")
        best = min(best, pack_rows(scene, slicing), key=lambda solution: solution.rank)
    return as_packing(scene, best, "finished")
