"""The built-in packers."""

from collections.abc import Iterable

import numpy as np

from amprep.hookspecs import Packer, PackerAccepts, hookimpl
from amprep.model.control import Report, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packing.params import ExtremePointsParams

amprep_api = 1


def _extreme_points(
    problem: PackingProblem,
    *,
    params: ExtremePointsParams,
    rng: np.random.Generator,
    stop: Stop,
    report: Report,
) -> Packing:
    from amprep.plugins.packing.extreme_points import pack_extreme_points

    return pack_extreme_points(problem, params=params, rng=rng, stop=stop, report=report)


@hookimpl
def amprep_packers() -> Iterable[Packer]:
    """Yield the built-in packers."""
    yield Packer(
        name="extreme-points",
        summary="The best of many sortings, each item at its best extreme point (Crainic, Perboli, Tadei).",
        run=_extreme_points,
        accepts=PackerAccepts(
            volumes=frozenset({"box", "boxes"}),
            objectives=frozenset({"builds", "fill"}),
            orientations=frozenset({"fixed", "axis", "list"}),
            cylinder=True,
            zones=True,
            fixed=True,
        ),
        params=ExtremePointsParams,
    )
