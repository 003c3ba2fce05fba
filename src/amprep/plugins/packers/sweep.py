"""Packings of layers of rows: nothing is quicker, and most of the room is used when boxes are small."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.rows import fill_rows
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.instance.orders import Pass
from amprep.plugins.packers.instance.prepare import Scene, prepare
from amprep.plugins.packers.instance.solution import Solution, as_packing
from amprep.plugins.packers.params import SweepParams


class Slicing(NamedTuple):
    """Axes along which boxes stand in a row, rows in a layer, layers in a build; and the order of boxes."""

    along: int
    across: int
    up: int
    order: Int64s


def slicings(scene: Scene, items: Int64s) -> Iterator[Slicing]:
    """Yield the choices of axes; for `fill` boxes worth much for their volume come first, or high ones."""
    value = np.array([item.value for item in scene.problem.items])
    for along, across, up in permutations(range(3)):
        if scene.space.flat and up != 2:
            continue
        size, _ = _turned(scene, across, up)
        by_height = (items, -size[items, along], -size[items, across], -size[items, up])
        yield Slicing(along, across, up, items[np.lexsort(by_height)])
        if scene.problem.objective == "fill":
            density = value[items] / np.maximum(size[items].prod(axis=1), 1e-12)
            yield Slicing(along, across, up, items[np.lexsort((*by_height, -density))])


def _turned(scene: Scene, across: int, up: int) -> tuple[Floats, Int64s]:
    """Return each item's size ``(n, 3)`` with clearance, and its variant: the lowest that fits."""
    variants = [variant for kind in scene.kinds for variant in kind]
    first = np.cumsum([0, *(len(kind) for kind in scene.kinds)])
    owner = np.repeat(np.arange(len(scene.kinds)), np.diff(first))
    size = np.array([variant.size for variant in variants]).reshape(-1, 3)
    unfit = np.array([not np.isfinite(variant.home[0]) for variant in variants], np.bool_)
    order = np.lexsort((size[:, across], size[:, up], unfit, owner))
    chosen = order[first[:-1]]
    return (size[chosen] + scene.problem.clearance)[scene.kind], (chosen - first[:-1])[scene.kind]


def pack_rows(scene: Scene, slicing: Slicing) -> Solution:
    """Return the packing of one slicing, first fit over rows, layers and builds.

    Rank is by builds (or value), then by the sum of the boxes' heights in their builds.
    """
    axes, order = list(slicing[:3]), slicing.order
    size, variant = _turned(scene, slicing.across, slicing.up)
    room = scene.space.hi + scene.problem.clearance - scene.space.lo + scene.space.slack
    n, m = len(scene.kind), len(order)
    build, place = np.full(n, -1, np.int64), np.zeros((n, 3))
    turned = np.zeros((n, 3))
    most = 1 if scene.problem.objective == "fill" else n
    work = np.zeros((m, 6)), np.zeros((m, 4)), np.zeros(m)
    fill_rows(order, size[:, axes], room[axes], scene.space.flat, most, build, turned, *work)
    place[:, axes] = turned
    place[build >= 0] += scene.space.lo
    return Solution(Pass(order, np.empty(0)), _rank(scene, build, place + size), True, build, variant, place)


def _rank(scene: Scene, build: Int64s, far: Floats) -> tuple[float, ...]:
    """Return what is smaller for a better packing: fewer builds or more value, then lower builds."""
    placed = build >= 0
    height = float(far[placed, 2].sum())
    if scene.problem.objective == "fill":
        return (-sum(scene.problem.items[i].value for i in np.flatnonzero(placed).tolist()), height)
    return (float(build.max(initial=-1)), height)


def best_rows(scene: Scene, items: Int64s) -> Solution:
    """Return the best of all slicings of these items."""
    return min((pack_rows(scene, each) for each in slicings(scene, items)), key=lambda found: found.rank)


def with_rows(scene: Scene, found: Solution) -> Solution:
    """Complete a pass that had to end early: rows of what it left, or of everything where that takes fewer builds.

    A round plate, zones, or a build to be filled leave it as it is.
    """
    space, fixed = scene.space, scene.problem.fixed
    if scene.problem.objective == "fill" or space.radius or len(space.zone_lo):
        return found
    loose = np.flatnonzero(scene.free & (found.build < 0))
    rows = best_rows(scene, loose)
    begun = max(int(found.build.max(initial=-1)) + 1, 1 if fixed else 0)
    new = rows.build >= 0
    build = np.where(new, rows.build + begun, found.build)
    variant = np.where(new, rows.variant, found.variant)
    place = np.where(new[:, None], rows.place, found.place)
    if not fixed:
        whole = best_rows(scene, np.flatnonzero(scene.free))
        if whole.build.max(initial=-1) < build.max(initial=-1):
            build, variant, place = whole.build, whole.variant, whole.place
    rank = (0.0, float(build.max(initial=-1) + 1), np.inf, np.inf)
    return replace(found, rank=rank, complete=True, build=build, variant=variant, place=place)


def pack_sweep(
    problem: PackingProblem, *, params: SweepParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Pack by slicing builds along two axes, which leaves one-dimensional packing (Sweep 2003, thesis 2.2).

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
        progress(number / len(chosen), "trying slicings")
        best = min(best, pack_rows(scene, slicing), key=lambda solution: solution.rank)
    return as_packing(scene, best, "finished")
