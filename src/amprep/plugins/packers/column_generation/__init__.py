"""The packer `column-generation`: set covering over builds, priced by the fill problem."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.model.control import Progress, Stop, silent
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.bounds.combinatorial import builds_bound
from amprep.plugins.packers.bounds.fractional_cover import CoveringBound
from amprep.plugins.packers.column_generation.columns import (
    Column,
    arrangement_from,
    columns_of,
    count_of,
    remaining_items,
    single_columns,
)
from amprep.plugins.packers.column_generation.master import FractionalCover, fractional_cover, integer_cover
from amprep.plugins.packers.extreme_points import construct
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing, value_of
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare, restrict
from amprep.plugins.packers.integer_program import is_final, solve_instance
from amprep.plugins.packers.integer_program.solver import TOLERANCE
from amprep.plugins.packers.params import ColumnGenerationParams, ExtremePointsParams

MARGIN = 10.0 * TOLERANCE
"""Least excess over 1 of the value of a new column, and over a whole number of a bound that is rounded up."""


class Priced(NamedTuple):
    """Result of pricing: new columns, and an upper bound on the value of any build."""

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
    """Pack into the fewest builds by column generation (thesis 2.1, last paragraph)."""
    instance = prepare(problem)
    result = cover_by_builds(instance, params=params, rng=rng, stop=stop, progress=progress)
    return as_packing(instance, result)


def cover_by_builds(
    instance: PreparedInstance,
    *,
    params: ColumnGenerationParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Return the best arrangement that column generation finds, and the bound that it proves.

    First `CoveringBound` raises the bound by the same scheme over sets of boxes that are not proved impossible. Then
    the master problem covers the items by builds. Its dual values are the rewards of a fill problem that looks for a
    build of value above 1, by extreme points and, where they find none, by the integer program. Each time the program
    bounds the value of a build, the dual values divided by max(1, that bound) prove a bound on the builds (Farley
    1990, doi:10.1287/opre.38.5.922). In the end builds are chosen in whole numbers, by the covering program and by
    completing the first builds of the fractional cover.
    """
    known = construct(instance, params=ExtremePointsParams(), rng=rng, stop=stop, progress=progress)
    if is_final(instance, known, stop):
        return known
    every = np.arange(len(instance.type_of))
    columns = [*columns_of(instance, known.arrangement, instance, every), *single_columns(instance)]
    most, reason = known.arrangement.builds, "finished"
    best = columns[:most]
    relaxed = CoveringBound(instance, max(1, builds_bound(instance)))
    relaxed.prove(lambda: most, params.proof * 1e6, stop)
    demand, least = instance.demand, relaxed.builds
    if least >= most:
        return known._replace(bound=float(least), stop_reason="bound met")
    cover = fractional_cover(columns, demand, params)
    for number in range(params.rounds):
        progress(number / max(params.rounds, 1), f"{least} to {most} builds")
        priced = price_builds(instance, cover.price, params, rng, stop)
        proved = float(cover.price @ demand) / max(1.0, priced.bound * (1.0 + TOLERANCE))
        least = max(least, math.ceil(proved - MARGIN))
        if stop() or least >= most or not priced.columns:
            break
        columns += priced.columns
        cover = fractional_cover(columns, demand, params)
    else:
        reason = "work used up"
    for found in candidates(instance, columns, cover, params, rng, stop):
        if len(found) < most:
            best, most = found, len(found)
        if most <= least or stop():
            break
    reason = stop.reason if stop() else reason
    return PackerResult(arrangement_from(instance, best), float(least), reason)


def price_builds(
    instance: PreparedInstance,
    price: Floats,
    params: ColumnGenerationParams,
    rng: np.random.Generator,
    stop: Stop,
) -> Priced:
    """Return builds of value above 1, if any were found, and an upper bound on the value of any build.

    Parameters
    ----------
    price
        ``(types,)`` value of an item of each type.
    """
    items = np.flatnonzero(instance.free & (price[instance.type_of] > TOLERANCE / len(instance.type_of)))
    part = restrict(instance, items, "fill", price)
    quick = ExtremePointsParams(restarts=params.restarts)
    found = construct(part, params=quick, rng=rng, stop=stop, progress=silent)
    if value_of(part, found.arrangement) <= 1.0 + MARGIN:
        found = solve_instance(part, params=params, rng=rng, stop=stop, progress=silent)
    valuable = value_of(part, found.arrangement) > 1.0 + MARGIN
    columns = columns_of(instance, found.arrangement, part, items) if valuable else []
    # the items that were left out have a total value of at most the tolerance
    return Priced(columns, found.bound + TOLERANCE)


def candidates(
    instance: PreparedInstance,
    columns: list[Column],
    cover: FractionalCover,
    params: ColumnGenerationParams,
    rng: np.random.Generator,
    stop: Stop,
) -> Iterator[list[Column]]:
    """Yield covers in whole builds: of the covering program, and completed first builds of the fractional cover."""
    whole = integer_cover(columns, instance.demand, params, stop)
    if whole is not None:
        yield useful(instance, whole)
    fraction = cover.fraction
    order = np.argsort(-fraction, kind="stable")[: int((fraction > TOLERANCE).sum())]
    lengths = np.unique(np.linspace(1, len(order), params.roundings + 1).astype(int)[:-1])
    for length in lengths.tolist():
        if stop():
            return
        beginning = useful(instance, [columns[n] for n in order[:length].tolist()])
        found = completed(instance, beginning, rng, stop)
        if found is not None:
            yield found


def useful(instance: PreparedInstance, columns: list[Column]) -> list[Column]:
    """Return the columns without those whose items are all in earlier columns."""
    left, kept = instance.demand, []
    for column in columns:
        counts = column.counts(len(left))
        if (np.minimum(left, counts) > 0).any():
            kept.append(column)
            left = np.maximum(left - counts, 0)
    return kept


def completed(
    instance: PreparedInstance, beginning: list[Column], rng: np.random.Generator, stop: Stop
) -> list[Column] | None:
    """Return the columns and builds of the other items by extreme points; None when the time is too short."""
    items = remaining_items(instance, count_of(beginning, len(instance.types)))
    if not len(items):
        return beginning
    part = restrict(instance, items, "builds")
    rest = construct(part, params=ExtremePointsParams(), rng=rng, stop=stop, progress=silent)
    if (rest.arrangement.build < 0).any():
        return None
    return [*beginning, *columns_of(instance, rest.arrangement, part, items)]
