"""The built-in packers."""

from collections.abc import Iterable

import numpy as np

from amprep.hookspecs import Packer, PackerAccepts, hookimpl
from amprep.model.control import Report, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packing.ip_params import ColumnGenerationParams, IpLocalSearchParams, IpParams
from amprep.plugins.packing.params import (
    AutoParams,
    BlockBuildingParams,
    ExtremePointsParams,
    SweepParams,
    TabuParams,
)

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


def _auto(
    problem: PackingProblem, *, params: AutoParams, rng: np.random.Generator, stop: Stop, report: Report
) -> Packing:
    from amprep.plugins.packing.auto import pack_auto

    return pack_auto(problem, params=params, rng=rng, stop=stop, report=report)


def _sweep(
    problem: PackingProblem, *, params: SweepParams, rng: np.random.Generator, stop: Stop, report: Report
) -> Packing:
    from amprep.plugins.packing.sweep import pack_sweep

    return pack_sweep(problem, params=params, rng=rng, stop=stop, report=report)


def _tabu(
    problem: PackingProblem, *, params: TabuParams, rng: np.random.Generator, stop: Stop, report: Report
) -> Packing:
    from amprep.plugins.packing.tabu import pack_tabu

    return pack_tabu(problem, params=params, rng=rng, stop=stop, report=report)


def _ip(
    problem: PackingProblem, *, params: IpParams, rng: np.random.Generator, stop: Stop, report: Report
) -> Packing:
    from amprep.plugins.packing.ip import pack_ip

    return pack_ip(problem, params=params, rng=rng, stop=stop, report=report)


def _ip_local_search(
    problem: PackingProblem,
    *,
    params: IpLocalSearchParams,
    rng: np.random.Generator,
    stop: Stop,
    report: Report,
) -> Packing:
    from amprep.plugins.packing.ip_local_search import pack_ip_local_search

    return pack_ip_local_search(problem, params=params, rng=rng, stop=stop, report=report)


def _column_generation(
    problem: PackingProblem,
    *,
    params: ColumnGenerationParams,
    rng: np.random.Generator,
    stop: Stop,
    report: Report,
) -> Packing:
    from amprep.plugins.packing.column_generation import pack_column_generation

    return pack_column_generation(problem, params=params, rng=rng, stop=stop, report=report)


def _block_building(
    problem: PackingProblem,
    *,
    params: BlockBuildingParams,
    rng: np.random.Generator,
    stop: Stop,
    report: Report,
) -> Packing:
    from amprep.plugins.packing.block_building import pack_block_building

    return pack_block_building(problem, params=params, rng=rng, stop=stop, report=report)


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
    yield Packer(
        name="auto",
        summary="Extreme points at once, then a search that packs a few builds anew until one is saved.",
        run=_auto,
        accepts=PackerAccepts(
            volumes=frozenset({"box", "boxes"}),
            objectives=frozenset({"builds", "fill"}),
            orientations=frozenset({"fixed", "axis", "list"}),
            cylinder=True,
            zones=True,
            fixed=True,
        ),
        params=AutoParams,
    )
    yield Packer(
        name="block-building",
        summary="Beam search over blocks of boxes in maximal empty spaces (Araya, Riff; Fanslau, Bortfeldt).",
        run=_block_building,
        accepts=PackerAccepts(
            objectives=frozenset({"fill"}),
            orientations=frozenset({"fixed", "axis"}),
            zones=True,
            fixed=True,
        ),
        params=BlockBuildingParams,
    )
    yield Packer(
        name="sweep",
        summary="Builds sliced into layers and rows, rows packed along one axis (Sweep 2003).",
        run=_sweep,
        accepts=PackerAccepts(
            volumes=frozenset({"box", "boxes"}),
            objectives=frozenset({"builds", "fill"}),
            orientations=frozenset({"fixed", "axis", "list"}),
        ),
        params=SweepParams,
    )
    yield Packer(
        name="tabu",
        summary="Tabu search that empties one build after another (Lodi, Martello, Vigo; thesis 2.4).",
        run=_tabu,
        accepts=PackerAccepts(
            volumes=frozenset({"box", "boxes"}),
            objectives=frozenset({"builds"}),
            orientations=frozenset({"fixed", "axis", "list"}),
            zones=True,
        ),
        params=TabuParams,
    )
    yield Packer(
        name="ip",
        summary="The thesis's integer program, by HiGHS or any solver of pulp, after extreme points.",
        run=_ip,
        accepts=PackerAccepts(
            volumes=frozenset({"box", "boxes"}),
            objectives=frozenset({"builds", "fill"}),
            orientations=frozenset({"fixed", "axis"}),
            zones=True,
            fixed=True,
        ),
        params=IpParams,
    )
    yield Packer(
        name="ip-local-search",
        summary="Steps to the best build near the last one, by the integer program (thesis 2.2).",
        run=_ip_local_search,
        accepts=PackerAccepts(
            volumes=frozenset({"box", "boxes"}),
            objectives=frozenset({"fill"}),
            orientations=frozenset({"fixed", "axis"}),
            zones=True,
            fixed=True,
        ),
        params=IpLocalSearchParams,
    )
    yield Packer(
        name="column-generation",
        summary="Set covering over builds, priced by the fill problem; proves bounds (thesis 2.1).",
        run=_column_generation,
        accepts=PackerAccepts(
            volumes=frozenset({"box", "boxes"}),
            objectives=frozenset({"builds"}),
            orientations=frozenset({"fixed", "axis"}),
            zones=True,
        ),
        params=ColumnGenerationParams,
    )
