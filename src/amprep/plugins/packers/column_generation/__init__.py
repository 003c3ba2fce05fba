"""The packer `column-generation`: set covering over builds, priced by the fill problem."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.model.control import Progress, Stop, silent
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.bounds.fractional_cover import CoverBound
from amprep.plugins.packers.bounds.volume import builds_bound
from amprep.plugins.packers.column_generation.columns import (
    Column,
    arrangement_from,
    columns_of,
    count_of,
    demand_of,
    part_of,
    remaining_items,
    single_columns,
)
from amprep.plugins.packers.column_generation.master import Fractional, fractional_cover, whole_cover
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.instance.prepare import Scene, prepare
from amprep.plugins.packers.integer_program import as_packing, pack_ip, settled
from amprep.plugins.packers.integer_program.solver import TOLERANCE
from amprep.plugins.packers.params import ColumnGenerationParams, ExtremePointsParams

MARGIN = 10.0 * TOLERANCE
"""By how much a price must exceed 1 to be worth a column, and a bound a whole number to be rounded up."""


class Priced(NamedTuple):
    """What pricing found: builds worth more than they cost, and a bound on what any build is worth."""

    columns: list[Column]
    bound: float


def pack_column_generation(
    problem: PackingProblem,
    *,
    params: ColumnGenerationParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack into the fewest builds by column generation (thesis 2.1, last paragraph).

    First `CoverBound` raises the bound by the same scheme over sets of boxes that are not proved impossible.
    Then the master problem covers the items by builds; its dual values are the rewards of a fill problem that
    looks for a build worth more than 1, by extreme points and, where that finds none, by the integer program.
    The bound is proved each time the program bounds what a build is worth: by dual values divided by
    max(1, that bound) (Farley 1990, doi:10.1287/opre.38.5.922). Then builds are chosen in whole numbers, by
    the covering program and by completing beginnings of the fractional cover.
    """
    known = pack_extreme_points(problem, params=ExtremePointsParams(), rng=rng, stop=stop, progress=progress)
    scene = prepare(problem)
    if settled(scene, known, stop):
        return known
    columns = [*columns_of(scene, known), *single_columns(scene)]
    best, most, reason = columns[: len(known.builds)], len(known.builds), "finished"
    relaxed = CoverBound(scene, max(1, builds_bound(scene)))
    relaxed.prove(lambda: most, params.proof * 1e6, stop)
    demand, least = demand_of(scene), relaxed.builds
    if least >= most:
        status = known.status if known.unplaced else "optimal"
        return replace(known, bound=float(least), status=status, stop_reason="bound met")
    cover = fractional_cover(columns, demand, params)
    for number in range(params.rounds):
        progress(number / max(params.rounds, 1), f"{least} to {most} builds")
        priced = price_builds(scene, cover.price, params, rng, stop)
        proved = float(cover.price @ demand) / max(1.0, priced.bound * (1.0 + TOLERANCE))
        least = max(least, math.ceil(proved - MARGIN))
        if stop() or least >= most or not priced.columns:
            break
        columns += priced.columns
        cover = fractional_cover(columns, demand, params)
    else:
        reason = "work used up"
    for found in candidates(scene, columns, cover, params, rng, stop):
        if len(found) < most:
            best, most = found, len(found)
        if most <= least or stop():
            break
    arrangement = arrangement_from(scene, best)
    return as_packing(scene, arrangement, float(least), stop.reason if stop() else reason)


def price_builds(
    scene: Scene, price: Floats, params: ColumnGenerationParams, rng: np.random.Generator, stop: Stop
) -> Priced:
    """Return builds worth more than 1 at these prices, if any were found, and a bound on their worth."""
    items = np.flatnonzero(scene.free & (price[scene.kind] > TOLERANCE / len(scene.kind)))
    part = part_of(scene, items, "fill", price)
    quick = ExtremePointsParams(restarts=params.restarts)
    found = pack_extreme_points(part.problem, params=quick, rng=rng, stop=stop, progress=silent)
    if worth_of(found, part.problem) <= 1.0 + MARGIN:
        found = pack_ip(part.problem, params=params, rng=rng, stop=stop, progress=silent)
    # items left out as worth nothing may be worth the tolerance all together
    bound = math.inf if found.bound is None else found.bound + TOLERANCE
    worth = worth_of(found, part.problem) > 1.0 + MARGIN
    return Priced(part.columns(found) if worth else [], bound)


def worth_of(packing: Packing, problem: PackingProblem) -> float:
    """Return the total value of what is placed."""
    return float(sum(problem.items[p.item].value for build in packing.builds for p in build))


def candidates(
    scene: Scene,
    columns: list[Column],
    cover: Fractional,
    params: ColumnGenerationParams,
    rng: np.random.Generator,
    stop: Stop,
) -> Iterator[list[Column]]:
    """Yield covers in whole builds: of the covering program, and completed beginnings of the fractional."""
    demand = demand_of(scene)
    whole = whole_cover(columns, demand, params, stop)
    if whole is not None:
        yield useful(scene, whole)
    order = np.argsort(-cover.share, kind="stable")[: int((cover.share > TOLERANCE).sum())]
    lengths = np.unique(np.linspace(1, len(order), params.roundings + 1).astype(int)[:-1])
    for length in lengths.tolist():
        if stop():
            return
        beginning = useful(scene, [columns[n] for n in order[:length].tolist()])
        found = completed(scene, beginning, rng, stop)
        if found is not None:
            yield found


def useful(scene: Scene, columns: list[Column]) -> list[Column]:
    """Return the columns that hold an item which none before them holds."""
    left, kept = demand_of(scene), []
    for column in columns:
        counts = column.counts(len(left))
        if (np.minimum(left, counts) > 0).any():
            kept.append(column)
            left = np.maximum(left - counts, 0)
    return kept


def completed(
    scene: Scene, beginning: list[Column], rng: np.random.Generator, stop: Stop
) -> list[Column] | None:
    """Return the columns and, after them, builds by extreme points for the rest; None without the time."""
    items = remaining_items(scene, count_of(beginning, len(scene.kinds)))
    if not len(items):
        return beginning
    part = part_of(scene, items, "builds")
    rest = pack_extreme_points(
        part.problem, params=ExtremePointsParams(), rng=rng, stop=stop, progress=silent
    )
    return None if rest.unplaced else [*beginning, *part.columns(rest)]
