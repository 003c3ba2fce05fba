"""A scene of single boxes in whole numbers, as the kernels of `block-building` read it."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.plugins.packers.bounds.volume import fill_bound
from amprep.plugins.packers.instance.prepare import Scene

GRAIN = 1e-6
"""mm; the finest unit of length."""

MOST_UNITS = 1 << 30
"""Units along the room's longest side, at most."""


@dataclass(frozen=True, eq=False)
class Whole:
    """Boxes, room and obstacles in units, clearance added at the upper sides.

    Attributes
    ----------
    unit
        mm, the greatest that measures every box exactly, if there is one above `GRAIN`.
    room
        ``(6,)`` corners; the least one is the origin.
    obstacles
        ``(m, 6)`` corners of zones and fixed boxes.
    singles, kind, variant
        ``(s, 3)`` sides of a box in one orientation, and ``(s,)`` its kind and the scene's variant.
    items
        Items of each kind: those of a kind share volume, orientations and value.
    worth
        ``(s,)`` value, above 0; that of a worthless box is next to nothing.
    goal
        Value of what is to be placed that nothing can exceed.
    """

    unit: float
    room: Int64s
    obstacles: Int64s
    singles: Int64s
    kind: Int64s
    variant: Int64s
    items: tuple[Int64s, ...]
    worth: Floats
    goal: float

    @property
    def stock(self) -> Int64s:
        """``(k,)`` number of boxes of each kind."""
        return np.array([len(items) for items in self.items], dtype=np.int64)


def is_of_single_boxes(scene: Scene) -> bool:
    """Whether every item is one box and the room is one, so that blocks can be built."""
    return scene.space.radius == 0.0 and all(len(v.lo) == 1 for kind in scene.kinds for v in kind)


def whole_scene(scene: Scene) -> Whole:
    """Return the scene in whole numbers; rounding makes boxes larger and rooms smaller, never the reverse."""
    gap, space, values = scene.problem.clearance, scene.space, _values(scene)
    groups, items = _groups(scene, values)
    rows = [
        (group, number)
        for group, kind in enumerate(groups)
        for number, variant in enumerate(scene.kinds[kind])
        if np.isfinite(variant.home[0])
    ]
    sizes = np.array([scene.kinds[groups[g]][v].size + gap for g, v in rows]).reshape(-1, 3)
    lo = np.concatenate((space.zone_lo + gap, scene.standing_lo)) - space.lo
    hi = np.concatenate((space.zone_hi, scene.standing_hi + gap)) - space.lo
    far = space.hi + gap - space.lo
    unit = _unit(sizes, lo, hi, float(far.max()))
    fixed = sum(values[placement.item] for placement in scene.problem.fixed)
    least = 1e-9 * max(float(values.max(initial=0.0)), 1e-3)
    return Whole(
        unit=unit * GRAIN,
        room=np.concatenate((np.zeros(3, np.int64), _down(far + space.slack, unit))),
        obstacles=np.hstack((_down(lo + space.slack, unit), _up(hi - space.slack, unit))),
        singles=np.maximum(_up(sizes, unit), 1),
        kind=np.array([group for group, _ in rows], dtype=np.int64),
        variant=np.array([variant for _, variant in rows], dtype=np.int64),
        items=tuple(items),
        worth=np.array([max(values[items[group][0]], least) for group, _ in rows]),
        goal=(fill_bound(scene) - float(fixed)) * (1.0 - 1e-9),
    )


def _values(scene: Scene) -> Floats:
    return np.array([item.value for item in scene.problem.items], dtype=np.float64)


def _groups(scene: Scene, values: Floats) -> tuple[list[int], list[Int64s]]:
    """Return for each pair of kind and value the scene's kind and its free items."""
    free = np.flatnonzero(scene.free)
    members: dict[tuple[int, float], list[int]] = {}
    for item in free.tolist():
        members.setdefault((int(scene.kind[item]), float(values[item])), []).append(item)
    return [kind for kind, _ in members], [np.array(found, dtype=np.int64) for found in members.values()]


def _unit(sizes: Floats, lo: Floats, hi: Floats, longest: float) -> int:
    """Return the unit in grains: the greatest common divisor of all lengths, or more when that is too fine."""
    lengths = np.concatenate((sizes.ravel(), lo.ravel(), hi.ravel()))
    grains = np.rint(np.abs(lengths) / GRAIN).astype(np.int64)
    divisor = int(np.gcd.reduce(grains)) if len(grains) else 1
    return max(divisor, int(np.ceil(longest / GRAIN / MOST_UNITS)), 1)


def _up(lengths: Floats, unit: int) -> Int64s:
    return np.asarray(-_down(-lengths, unit))


def _down(lengths: Floats, unit: int) -> Int64s:
    """Return lengths in units, rounded down but for what is surely an error of rounding."""
    return np.asarray(np.floor(lengths / GRAIN + 1e-3).astype(np.int64) // unit)
