"""The passes of `extreme-points`: orders of the items, each with a style of choosing places."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.places import CENTRE, LOW, RESIDUAL, TOUCHING
from amprep.plugins.packers.instance.prepare import Scene

BANDS = (0.1, 0.2, 0.3, 0.5)
"""Widths of the clusters, as shares of the build volume's area or height."""


EARLY = (
    (0, 1), (2, 0), (24, 2), (21, 0), (0, 2), (3, 0), (5, 1), (9, 0), (10, 0), (12, 0), (14, 2), (28, 0),
)  # fmt: skip
"""Orders and styles by number that, one after another, saved most builds over classes 1 to 8 of Martello, Pisinger
and Vigo with 50, 100 and 200 boxes; there the other 75 passes saved none beyond these."""

ENOUGH, ALL = 12, 1000

MANY = 500
"""Items from which passes by touching areas come last: they take some twenty times as long as the others."""


class Pass(NamedTuple):
    """One order of items (indices) and one way to place them."""

    order: Int64s
    style: Floats


def passes(scene: Scene) -> list[Pass]:
    """Return every order under every style, in an order in which the best come early."""
    styles, orders = list(_styles(scene)), list(_orders(scene))
    every = [(order, style) for order in range(len(orders)) for style in range(len(styles))]
    if _is_stacked(scene):
        early = [pair for pair in EARLY if pair in every]
        every = early + [pair for pair in every if pair not in early]
        if np.count_nonzero(scene.free) > MANY:
            every.sort(key=lambda pair: styles[pair[1]][0] == TOUCHING)
    return [Pass(orders[order], styles[style]) for order, style in every]


def enough_passes(scene: Scene) -> int:
    """Return how many of the passes are worth their time where time is short."""
    return ENOUGH if _is_stacked(scene) and scene.problem.objective == "builds" else ALL


def _is_stacked(scene: Scene) -> bool:
    """Whether boxes may lie above one another in a box, for which `EARLY` was found."""
    return not (scene.space.radius or scene.space.flat)


def _styles(scene: Scene) -> Iterator[Floats]:
    """Yield the ways to choose places that suit the room."""
    x, y, z = np.maximum(scene.space.hi - scene.space.lo, 1e-9).tolist()
    rows = [1.0 / x, 1e3 / y, 1e6 / z]
    columns = [1e3 / x, 1.0 / y, 1e6 / z]
    if scene.space.radius:
        for phase in range(4):
            yield _style(CENTRE, [0.0, 0.0, 1e3 * x], GRID, phase)
            yield _style(LOW, rows, 0, phase)
            yield _style(LOW, columns, 0, phase)
            yield _style(TOUCHING, rows, GRID, phase)
    elif scene.space.flat:
        yield _style(LOW, rows, GRID)
        yield _style(LOW, columns, GRID)
        yield _style(TOUCHING, rows, GRID)
        yield _style(RESIDUAL, rows)
    else:
        yield _style(RESIDUAL, rows)
        yield _style(TOUCHING, rows)
        yield _style(LOW, rows)


def _style(merit: int, weights: list[float], grid: int = 0, phase: int = 0) -> Floats:
    """Return a style as the kernel reads it."""
    return np.array([merit, *weights, grid, phase], dtype=np.float64)


GRID = 1024
"""Crossings of lines tried besides the extreme points, at most."""


def _orders(scene: Scene) -> Iterator[Int64s]:
    """Yield orders of the free items, each once."""
    free = np.flatnonzero(scene.free)
    seen: set[bytes] = set()
    for keys in _keys(scene, free):
        # ties keep copies of a part together: rows of identical parts
        columns = np.array([free, scene.kind[free], *(-key for key in reversed(keys))], dtype=np.float64)
        order = free[np.lexsort(columns)]
        if order.tobytes() not in seen:
            seen.add(order.tobytes())
            yield order


def _keys(scene: Scene, free: Int64s) -> Iterator[tuple[Floats, ...]]:
    """Yield sort keys, greatest first; the first key of a tuple rules."""
    size = np.array([variants[0].size for variants in scene.kinds]).reshape(-1, 3)[scene.kind[free]]
    room = np.maximum(scene.space.hi - scene.space.lo, 1e-9)
    volume, area = size.prod(axis=1), size[:, 0] * size[:, 1]
    measure = area if scene.space.flat else volume
    if scene.problem.objective == "fill":
        value = np.array([scene.problem.items[i].value for i in free.tolist()])
        yield (value / np.maximum(measure, 1e-12), value)
        yield (value, -measure)
        yield (value / np.maximum(np.sqrt(measure), 1e-12), value)
    yield (measure,)
    yield (size.max(axis=1), measure)
    yield (size[:, :2].max(axis=1) if scene.space.flat else size.min(axis=1), measure)
    yield (size.sum(axis=1), measure)
    yield (size[:, 2], area)
    yield from _clustered(size, room, (0, 1) if scene.space.flat else (2, 1, 0), flat=scene.space.flat)


def _clustered(
    size: Floats, room: Floats, axes: tuple[int, ...], *, flat: bool
) -> Iterator[tuple[Floats, ...]]:
    """Yield the clustered area-height and height-area sortings along each axis, band by band."""
    for band in BANDS:
        for axis in axes:
            across = [a for a in ((0, 1) if flat else (0, 1, 2)) if a != axis]
            area, height = size[:, across].prod(axis=1), size[:, axis]
            yield (np.ceil(area / (room[across].prod() * band) - 1e-9), height, area)
            yield (np.ceil(height / (room[axis] * band) - 1e-9), area, height)
