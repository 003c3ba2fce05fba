"""A solution as arrays, to and from a packing, and to the values of a program's variables."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.model.packing import Packing, Placement, Unplaced
from amprep.plugins.packers.instance.prepare import Scene, placements


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Where the items that are not fixed stand.

    Attributes
    ----------
    build, variant
        ``(n,)`` int64, -1 for items in no build.
    place
        ``(n, 3)`` mm, least corners.
    """

    build: Int64s
    variant: Int64s
    place: Floats


def nothing_placed(scene: Scene) -> Arrangement:
    """Return the arrangement without any item."""
    n = len(scene.kind)
    return Arrangement(np.full(n, -1, np.int64), np.full(n, -1, np.int64), np.zeros((n, 3)))


def arrangement_of(scene: Scene, packing: Packing) -> Arrangement:
    """Return a packing of this scene as arrays."""
    found, fixed = nothing_placed(scene), {placement.item for placement in scene.problem.fixed}
    for number, build in enumerate(packing.builds):
        for placement in build:
            if placement.item not in fixed:
                kind = scene.kinds[scene.kind[placement.item]]
                variant = [np.array_equal(v.rotation, placement.rotation) for v in kind].index(True)
                found.build[placement.item], found.variant[placement.item] = number, variant
                found.place[placement.item] = placement.translation - kind[variant].shift
    return found


def builds_of(scene: Scene, arrangement: Arrangement) -> tuple[tuple[Placement, ...], ...]:
    """Return the builds, the fixed placements first, then by item; without empty ones."""
    builds = []
    for number in range(max(int(arrangement.build.max(initial=-1)) + 1, 1)):
        items = np.flatnonzero(arrangement.build == number)
        placed = placements(
            scene, items.tolist(), arrangement.variant[items].tolist(), arrangement.place[items]
        )
        builds.append((*(scene.problem.fixed if number == 0 else ()), *placed))
    return tuple(build for build in builds if build)


def left_out(scene: Scene, arrangement: Arrangement, reason: str) -> tuple[Unplaced, ...]:
    """Return the items in no build, with `reason` where they are not too large."""
    out = np.flatnonzero((scene.free & (arrangement.build < 0)) | scene.too_large).tolist()
    return tuple(Unplaced(item, "too large" if scene.too_large[item] else reason) for item in out)


def value_of(scene: Scene, arrangement: Arrangement) -> float:
    """Return the value of what is placed, fixed items included."""
    fixed = [placement.item for placement in scene.problem.fixed]
    items = [*np.flatnonzero(arrangement.build >= 0).tolist(), *fixed]
    return float(sum(scene.problem.items[item].value for item in items))
