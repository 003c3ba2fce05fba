"""The packer `sweep`: builds sliced into layers of rows; fast, and dense when the boxes are small."""

from collections.abc import Iterator
from itertools import permutations
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.records import Arrangement
from amprep.kernels.boxes.rows import RowScratch, fill_rows
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.bounds.combinatorial import packing_bound
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare
from amprep.plugins.packers.params import SweepParams


class Slicing(NamedTuple):
    """Axes along which boxes form a row, rows a layer, layers a build; and the order of the boxes."""

    along: int
    across: int
    up: int
    order: Int64s


class SlicedPacking(NamedTuple):
    """The packing of one slicing; its rank is smaller for a better one."""

    arrangement: Arrangement
    rank: tuple[float, ...]


def pack_sweep(
    problem: PackingProblem, *, params: SweepParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Pack by slicing builds along two axes, which leaves one-dimensional packing (Sweep 2003, thesis 2.2).

    The boxes are sorted by decreasing height. Each goes first fit into a row with enough depth and height, else it
    starts a row in the first layer with enough height, else a layer in the first build with room, else a build. All
    choices of axes are tried and the best packing is kept. Without stacking there is one layer, on the plate. An
    item of several boxes takes the room of its enclosing box. No random numbers are drawn.
    """
    del rng
    instance = prepare(problem)
    chosen = list(slicings(instance, np.flatnonzero(instance.free)))[: params.slicings or None]
    best, reason = pack_rows(instance, chosen[0]), "finished"
    for number, slicing in enumerate(chosen[1:], start=1):
        if stop():
            reason = stop.reason
            break
        progress(number / len(chosen), "trying slicings")
        best = min(best, pack_rows(instance, slicing), key=lambda found: found.rank)
    return as_packing(instance, PackerResult(best.arrangement, packing_bound(instance), reason))


def slicings(instance: PreparedInstance, items: Int64s) -> Iterator[Slicing]:
    """Yield the choices of axes; in a fill problem the boxes are sorted by value per volume, and by height."""
    value = np.array([item.value for item in instance.problem.items])
    for along, across, up in permutations(range(3)):
        if instance.space.flat and up != 2:
            continue
        size, _ = _turned(instance, across, up)
        by_height = (items, -size[items, along], -size[items, across], -size[items, up])
        yield Slicing(along, across, up, items[np.lexsort(by_height)])
        if instance.filling:
            density = value[items] / np.maximum(size[items].prod(axis=1), 1e-12)
            yield Slicing(along, across, up, items[np.lexsort((*by_height, -density))])


def _turned(instance: PreparedInstance, across: int, up: int) -> tuple[Floats, Int64s]:
    """Return each item's size ``(n, 3)`` mm with clearance, and its orientation: the lowest that fits."""
    first = instance.first_orientation
    owner = np.repeat(np.arange(len(instance.types)), np.diff(first))
    size = np.array([orientation.size for orientation in instance.orientations]).reshape(-1, 3)
    unfit = np.array([not orientation.fits for orientation in instance.orientations], np.bool_)
    chosen = np.lexsort((size[:, across], size[:, up], unfit, owner))[first[:-1]]
    return (size[chosen] + instance.problem.clearance)[instance.type_of], chosen[instance.type_of]


def pack_rows(instance: PreparedInstance, slicing: Slicing) -> SlicedPacking:
    """Return the packing of one slicing, first fit over rows, layers and builds.

    It is ranked by builds (or value), then by the sum of the heights that the boxes reach in their builds.
    """
    axes, order = list(slicing[:3]), slicing.order
    size, orientation = _turned(instance, slicing.across, slicing.up)
    space = instance.space
    room = space.hi + instance.problem.clearance - space.lo + space.slack
    n, m = len(instance.type_of), len(order)
    build, position = np.full(n, -1, np.int64), np.zeros((n, 3))
    turned = np.zeros((n, 3))
    most = 1 if instance.filling else n
    scratch = RowScratch(np.zeros((m, 6)), np.zeros((m, 4)), np.zeros(m))
    fill_rows(order, size[:, axes], room[axes], space.flat, most, build, turned, scratch)
    position[:, axes] = turned
    position[build >= 0] += space.lo
    return SlicedPacking(Arrangement(build, orientation, position), _rank(instance, build, position + size))


def _rank(instance: PreparedInstance, build: Int64s, far: Floats) -> tuple[float, ...]:
    """Return the rank: fewer builds or more value first, then lower builds."""
    placed = build >= 0
    height = float(far[placed, 2].sum())
    if instance.filling:
        return (-sum(instance.problem.items[i].value for i in np.flatnonzero(placed).tolist()), height)
    return (float(build.max(initial=-1)), height)


def best_rows(instance: PreparedInstance, items: Int64s) -> Arrangement:
    """Return the best of all slicings of these items."""
    packed = (pack_rows(instance, slicing) for slicing in slicings(instance, items))
    return min(packed, key=lambda found: found.rank).arrangement


def with_rows(instance: PreparedInstance, found: Arrangement) -> Arrangement | None:
    """Complete an arrangement: rows of its unassigned items, or of all items where that takes fewer builds.

    The result is None on a round plate, beside forbidden zones, and in a fill problem, where rows are not packed.
    """
    space, fixed = instance.space, instance.problem.fixed
    if instance.in_one_build or space.radius or len(space.zone_lo):
        return None
    rows = best_rows(instance, np.flatnonzero(instance.free & (found.build < 0)))
    begun = max(found.builds, 1 if fixed else 0)
    new = rows.build >= 0
    completed = Arrangement(
        np.where(new, rows.build + begun, found.build),
        np.where(new, rows.orientation, found.orientation),
        np.where(new[:, None], rows.position, found.position),
    )
    if fixed:
        return completed
    whole = best_rows(instance, np.flatnonzero(instance.free))
    return whole if whole.builds < completed.builds else completed
