"""The packer `sweep`: builds are sliced into layers, layers into rows, and rows packed along one axis."""

from collections.abc import Iterator
from itertools import permutations
from typing import NamedTuple

import numpy as np

from amprep.kernels.box_places import Indices
from amprep.model.arrays import Floats
from amprep.model.control import Report, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packing.extreme_points import Solution, as_packing
from amprep.plugins.packing.params import SweepParams
from amprep.plugins.packing.scene import Scene, prepare
from amprep.plugins.packing.sortings import Pass

ROUNDING = 1e-9


class Slicing(NamedTuple):
    """Axes along which boxes stand in a row, rows in a layer, layers in a build; and the order of boxes."""

    along: int
    across: int
    up: int
    order: Indices


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
    slicings = list(_slicings(scene))[: params.slicings or None]
    best = _pack(scene, slicings[0])
    for number, slicing in enumerate(slicings[1:], start=1):
        if stop():
            return as_packing(scene, best, stop.reason)
        report(number / len(slicings), "trying slicings")
        best = min(best, _pack(scene, slicing), key=lambda solution: solution.rank)
    return as_packing(scene, best, "finished")


def _slicings(scene: Scene) -> Iterator[Slicing]:
    """Yield the choices of axes; for `fill` boxes worth much for their volume come first, or high ones."""
    free = np.flatnonzero(scene.free)
    value = np.array([item.value for item in scene.problem.items])
    for along, across, up in permutations(range(3)):
        if scene.space.flat and up != 2:
            continue
        size, _ = _turned(scene, across, up)
        by_height = (free, -size[free, along], -size[free, across], -size[free, up])
        yield Slicing(along, across, up, free[np.lexsort(by_height)])
        if scene.problem.objective == "fill":
            density = value[free] / np.maximum(size[free].prod(axis=1), 1e-12)
            yield Slicing(along, across, up, free[np.lexsort((*by_height, -density))])


def _turned(scene: Scene, across: int, up: int) -> tuple[Floats, Indices]:
    """Return each item's size ``(n, 3)`` with clearance, and its variant: the lowest that fits."""
    sizes, chosen = np.zeros((len(scene.kinds), 3)), np.zeros(len(scene.kinds), np.int64)
    for kind, variants in enumerate(scene.kinds):
        fitting = [v for v, variant in enumerate(variants) if np.isfinite(variant.home[0])] or [0]
        chosen[kind] = min(fitting, key=lambda v: (variants[v].size[up], variants[v].size[across]))
        sizes[kind] = variants[chosen[kind]].size + scene.problem.clearance
    return sizes[scene.kind], chosen[scene.kind]


def _pack(scene: Scene, slicing: Slicing) -> Solution:
    """Return the packing of one slicing, first fit over rows, layers and builds."""
    along, across, up, order = slicing
    size, variant = _turned(scene, across, up)
    room = scene.space.hi + scene.problem.clearance - scene.space.lo + scene.space.slack
    n, least = len(scene.kind), scene.space.lo
    build, place = np.full(n, -1, np.int64), np.zeros((n, 3))
    # of each row: free length, depth, height, start across and up, build; of each layer: free depth, ...
    rows, row_count = np.zeros((len(order), 6)), 0
    layers, layer_count = np.zeros((len(order), 4)), 0
    builds: list[float] = []
    most = 1 if scene.problem.objective == "fill" else n
    for item in order.tolist():
        long, deep, high = size[item, along], size[item, across], size[item, up]
        fits = (rows[:row_count, :3] >= np.array([long, deep, high]) - ROUNDING).all(axis=1)
        if not fits.any():
            fits = (layers[:layer_count, :2] >= np.array([deep, high]) - ROUNDING).all(axis=1)
            if not fits.any():
                number = next((b for b, left in enumerate(builds) if left >= high - ROUNDING), len(builds))
                if number == most:
                    continue
                if number == len(builds):
                    builds.append(float(room[up]))
                layers[layer_count] = room[across], high, room[up] - builds[number], number
                layer_count += 1
                builds[number] = -1.0 if scene.space.flat else builds[number] - high
                fits = np.arange(layer_count) == layer_count - 1
            layer = layers[int(np.argmax(fits))]
            rows[row_count] = room[along], deep, layer[1], room[across] - layer[0], layer[2], layer[3]
            layer[0] -= deep
            row_count += 1
            fits = np.arange(row_count) == row_count - 1
        row = rows[int(np.argmax(fits))]
        build[item] = int(row[5])
        place[item, along], place[item, across], place[item, up] = room[along] - row[0], row[3], row[4]
        place[item] += least
        row[0] -= long
    return Solution(Pass(order, np.empty(0)), _rank(scene, build, place + size), True, build, variant, place)


def _rank(scene: Scene, build: Indices, far: Floats) -> tuple[float, ...]:
    """Return what is smaller for a better packing: fewer builds or more value, then lower builds."""
    placed = build >= 0
    height = float(far[placed, 2].sum())
    if scene.problem.objective == "fill":
        return (-sum(scene.problem.items[i].value for i in np.flatnonzero(placed).tolist()), height)
    return (float(build.max(initial=-1)), height)
