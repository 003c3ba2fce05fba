"""Fit the speed of a machine to the log of a build."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats

LEAST_LAYERS = 30
"""Least number of layers of a log."""

_EVERY = 3
"""Every third layer is fitted to find the error at the others."""

_PARTS = 10
_LEAST_SPREAD = 0.05
"""Least standard deviation of the areas, as a fraction of their mean, that tells recoating from scanning."""

_FAR = 4.0
"""Layers further from the line than this many standard deviations are paused ones."""

_ROUNDS = 20


class FittedSpeed(NamedTuple):
    """The speed of a machine, and how well it predicts layers that were not fitted.

    Attributes
    ----------
    recoating_s
        Seconds for each layer apart from the scanning.
    scan_mm2_s
        Area (mm2) that is scanned in a second.
    layers, left_out
        Number of layers, and of those that were left out because they took far longer or shorter than the others.
    total_error
        Fitted to every third layer: error of the total time of the other layers, as a fraction of that time.
    worst_error
        Largest such error of one of ten equal stretches of the other layers.
    """

    recoating_s: float
    scan_mm2_s: float
    layers: int
    left_out: int
    total_error: float
    worst_error: float


def fit_speed(seconds: Floats, area: Floats) -> FittedSpeed:
    """Return the speed that explains the durations of layers best.

    The duration of a layer is ``recoating_s + area / scan_mm2_s``. Layers that are far from this line, judged by the
    median of the distances, are left out, and the line is fitted again until nothing changes (an iterated least squares
    fit with rejection: Rousseeuw, Leroy 1987, *Robust Regression and Outlier Detection*).

    Parameters
    ----------
    seconds
        Duration of each layer ``(n,)``, the recoating included.
    area
        Area (mm2) that was scanned in each layer ``(n,)``.

    Raises
    ------
    ValueError
        When there are too few layers, their areas are too much alike, or more area does not take more time.
    """
    if len(seconds) < LEAST_LAYERS:
        raise ValueError(f"expected at least {LEAST_LAYERS} layers, got {len(seconds)}")
    if area.std() <= _LEAST_SPREAD * max(float(area.mean()), 1e-12):
        raise ValueError("the areas of its layers are too much alike to tell recoating from scanning")
    base, slope, kept = _line(seconds, area)
    if slope <= 0.0:
        raise ValueError("layers of larger area do not take longer in it")
    trained = np.arange(len(seconds)) % _EVERY == 0
    own_base, own_slope, _ = _line(seconds[trained], area[trained])
    others = ~trained & kept
    measured, predicted = seconds[others], own_base + own_slope * area[others]
    worst = max(
        _error(*each)
        for each in zip(*(np.array_split(x, _PARTS) for x in (measured, predicted)), strict=True)
    )
    left_out = int((~kept).sum())
    return FittedSpeed(base, 1.0 / slope, len(seconds), left_out, _error(measured, predicted), worst)


def _error(measured: Floats, predicted: Floats) -> float:
    """Return the error of a sum, as a fraction of the sum."""
    whole = float(measured.sum())
    return abs(float(predicted.sum()) - whole) / whole if whole else 0.0


def _line(seconds: Floats, area: Floats) -> tuple[float, float, Bools]:
    """Return base and slope of the line through the layers, the base not below 0, and which layers it is for."""
    kept = np.abs(seconds - np.median(seconds)) <= _width(seconds - np.median(seconds)) * 2.0 * _FAR
    for _ in range(_ROUNDS):
        base, slope = _least_squares(seconds[kept], area[kept])
        away = seconds - (base + slope * area)
        now = np.abs(away) <= _FAR * _width(away[kept])
        if (now == kept).all() or now.sum() < 3:
            break
        kept = now
    return base, slope, kept


def _least_squares(seconds: Floats, area: Floats) -> tuple[float, float]:
    rows = np.column_stack([np.ones(len(area)), area])
    base, slope = np.linalg.lstsq(rows, seconds, rcond=None)[0].tolist()
    if base >= 0.0:
        return float(base), float(slope)
    return 0.0, float(seconds @ area / max(float(area @ area), 1e-300))


def _width(away: Floats) -> float:
    """Return the standard deviation of normal distances with the same median, at least 1 ms."""
    return max(1.4826 * float(np.median(np.abs(away))), 1e-3)
