"""Make a constructed layout exact where its fields are not: separate it, and move what still overlaps on top."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.no_fit.records import PositionRange
from amprep.plugins.packers.separation.programs import EXACT, contacts_of, make_exact
from amprep.plugins.packers.separation.state import Placed, Scene, only


def repaired(scene: Scene, placed: Placed, within: PositionRange, most_builds: int) -> Placed:
    """Return a layout without overlaps near one whose overlaps are small; at least the items without overlaps stay.

    The others are put above all items of a build, into a build of their own, or left out, whatever is possible first.
    """
    exact = make_exact(scene, placed, within)
    if exact is not None or not len(placed.items):
        return placed if exact is None else exact
    moved = _overlapping(scene, placed)
    kept = np.setdiff1d(np.arange(len(placed.items)), moved)
    found, tops = placed.copy(), _tops(scene, only(placed, kept))
    for row in moved.tolist():
        if _put_above(scene, found, row, tops, within) or _put_alone(scene, found, row, tops, most_builds):
            kept = np.append(kept, row)
    return only(found, np.sort(kept))


def _overlapping(scene: Scene, placed: Placed) -> Int64s:
    """Return rows without which nothing overlaps: again and again the one that overlaps most others."""
    contacts, positions = contacts_of(scene, placed, 0.01), scene.layout(placed).position
    one, other = contacts.pairs.T
    gap = (contacts.planes[:, :3] * (positions[one] - positions[other])).sum(axis=1) - contacts.planes[:, 3]
    pairs = np.unique(contacts.pairs[gap < -EXACT], axis=0)
    rows: list[int] = []
    while len(pairs):
        counts = np.bincount(pairs.ravel(), minlength=len(placed.items))[: len(placed.items)]
        rows.append(int(counts.argmax()))
        pairs = pairs[(pairs != rows[-1]).all(axis=1)]
    return np.array(rows, np.int64)


def _tops(scene: Scene, placed: Placed) -> list[float]:
    """Return the height (mm) above which each build is free."""
    tops = [scene.instance.low[2]] * max(placed.builds, 1)
    for build, shape, position in zip(placed.build, placed.shape, placed.position, strict=True):
        tops[build] = max(tops[build], float(position[2] + scene.instance.size[shape, 2]))
    return [max(top, scene.no_fit.obstacle_top) for top in tops]


def _put_above(scene: Scene, placed: Placed, row: int, tops: list[float], within: PositionRange) -> bool:
    """Put a row above all of the lowest build, if that is high enough."""
    shape, build = int(placed.shape[row]), int(np.argmin(tops))
    height = max(tops[build] + scene.instance.problem.clearance, float(within.lo[shape, 2]))
    if height > within.hi[shape, 2]:
        return False
    placed.build[row], placed.position[row, 2] = build, height
    tops[build] = height + float(scene.instance.size[shape, 2])
    return True


def _put_alone(scene: Scene, placed: Placed, row: int, tops: list[float], most_builds: int) -> bool:
    """Put a row into a further build, if there may be one."""
    if len(tops) >= most_builds:
        return False
    position: Floats = scene.instance.shapes[int(placed.shape[row])].feasible_position
    if not np.isfinite(position).all():
        return False
    placed.build[row], placed.position[row] = len(tops), position
    top = float(position[2] + scene.instance.size[placed.shape[row], 2])
    tops.append(max(top, scene.no_fit.obstacle_top))
    return True
