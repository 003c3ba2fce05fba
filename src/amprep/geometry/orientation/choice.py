"""Choose a few among many orientations that are judged by several figures."""

from collections.abc import Callable, Iterable

import numpy as np

from amprep.arrays import Bools, Floats, Int64s


def non_dominated(costs: Floats) -> Bools:
    """Tell which rows of ``(k, c)`` costs no other row beats: none is at most as large everywhere and less somewhere.

    Of equal rows the first one is kept.
    """
    kept = np.ones(len(costs), np.bool_)
    for row in range(len(costs)):
        no_worse = (costs <= costs[row]).all(axis=1)
        less = (costs < costs[row]).any(axis=1)
        equal = no_worse & ~less
        kept[row] = not (no_worse & less).any() and not equal[:row].any()
    return kept


def balanced(costs: Floats) -> Floats:
    """Return one cost ``(k,)`` for each row of ``(k, c)`` costs: the mean over its columns, each scaled to 0 to 1.

    The scale of a column leads from its least to its median value, and values beyond the median count in full. Thus
    one very bad row does not make all others alike.
    """
    least, middle = costs.min(axis=0), np.median(costs, axis=0)
    scale = np.where(middle > least, middle - least, 1.0)
    return np.asarray(((costs - least) / scale).mean(axis=1))


def apart(
    order: Iterable[int],
    directions: Floats,
    most: int,
    angle_deg: float,
    allowed: Callable[[int], bool] | None = None,
) -> list[int]:
    """Return the first rows of an order whose directions ``(k, 3)`` are at least an angle apart, at most `most`.

    Rows that are not allowed are left out; only those are asked for that would be chosen.
    """
    chosen: list[int] = []
    near = np.cos(np.radians(angle_deg))
    for row in order:
        if len(chosen) == most:
            break
        if chosen and (directions[chosen] @ directions[row]).max() >= near:
            continue
        if allowed is None or allowed(row):
            chosen.append(int(row))
    return chosen


def ranked(*keys: Floats | Bools) -> Int64s:
    """Return the rows in the order of the first key, and of the next ones where it is equal to nine digits."""
    return np.lexsort([_rounded(key) for key in reversed(keys)])


def _rounded(key: Floats | Bools) -> Floats:
    """Return values without differences that rounding makes."""
    key = key.astype(np.float64)
    scale = float(np.abs(key).max(initial=0.0)) or 1.0
    return np.asarray(np.round(key / scale, 9))
