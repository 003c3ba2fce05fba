"""Conservative scales: lengths measured so that in no build their products add up to more than 1.

A dual feasible function u maps [0, 1] to [0, 1] so that numbers that add up to at most 1 keep doing so. Lengths
along each axis may be measured by such functions, each axis by its own: the boxes of a build then still have a
total volume of at most 1 (Fekete and Schepers, *A general framework for bounds for higher-dimensional
orthogonal packing problems*, Mathematical Methods of Operations Research 60 (2004),
doi:10.1007/s001860400376).
"""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats, Int64s

ROUNDING = 1e-12
MOST_CUTS, FEWEST_CUTS, MANY = 20, 3, 1000
"""Thresholds tried an axis, and the kinds beyond which they get fewer: many small boxes are bounded by volume."""

MULTIPLES = np.arange(2.0, 7.0)
"""k + 1 of u^(k)."""


def measures(length: Floats) -> Floats:
    """Return lengths ``(k,)``, as shares of the room, under each dual feasible function tried, ``(f, k)``.

    The functions are the identity, u^(k) and U^(e) of the paper, and f_2 of Carlier, Clautiaux and Moukrim,
    *New reduction procedures and lower bounds for the two-dimensional bin packing problem with fixed
    orientation*, Computers & Operations Research 34 (2007), doi:10.1016/j.cor.2005.08.012.
    """
    times = MULTIPLES[:, None] * length
    whole = np.abs(times - np.round(times)) < 1e-9
    multiples = np.where(whole, length, np.floor(times + ROUNDING) / (MULTIPLES[:, None] - 1.0))
    cut = _cuts(length)[:, None]
    clipped = np.where(length > 1.0 - cut + ROUNDING, 1.0, np.where(length < cut - ROUNDING, 0.0, length))
    return np.asarray(np.minimum(np.vstack((length[None], multiples, clipped, _rounded(length, cut))), 1.0))


def _cuts(length: Floats) -> Floats:
    """Return thresholds up to a half at which something changes, evenly chosen."""
    cuts = np.concatenate((length, 1.0 - length))
    cuts = cuts[np.unique(np.round(cuts, 12), return_index=True)[1]]
    cuts = cuts[(cuts > 1e-6) & (cuts <= 0.5 + ROUNDING)]
    most = max(FEWEST_CUTS, min(MOST_CUTS, MOST_CUTS * MANY // max(len(length), 1)))
    if len(cuts) > most:
        cuts = cuts[np.linspace(0, len(cuts) - 1, most).astype(int)]
    return np.asarray(cuts)


def _rounded(length: Floats, cut: Floats) -> Floats:
    """Return f_2 for each cut ``(c, 1)``: small lengths in whole cuts, large ones as what they leave.

    What limits is rounded up from further below than what is limited, so that rounding never proves too much.
    """
    cuts = np.floor(1.0 / cut + 1e-7)
    large = 2.0 * (cuts - np.floor((1.0 - length) / cut + 1e-7))
    small = 2.0 * np.floor(length / cut + 1e-10)
    half = np.abs(length - 0.5) <= ROUNDING
    return np.asarray(np.where(half, cuts, np.where(length > 0.5, large, small)) / (2.0 * cuts))


def heaviest_scale(share: Floats, demand: Int64s) -> float:
    """Return the greatest total of boxes under a conservative scale: no fewer builds can hold them.

    Parameters
    ----------
    share
        ``(k, 3)`` sides of each kind as shares of the room, at most 1.
    demand
        ``(k,)`` how many there are.
    """
    return float(_weights([measures(share[:, axis]) for axis in range(3)], demand).max(initial=0.0))


def heavy_scales(share: Floats, demand: Int64s, most: int) -> Floats:
    """Return the volume and the scales that weigh most, ``(k, s)``.

    Parameters
    ----------
    share, demand
        As in `heaviest_scale`.
    most
        Scales returned, at most; any two differ by more than 0.08 for some kind.
    """
    x, y, z = (measures(share[:, axis]) for axis in range(3))
    weight = _weights([x, y, z], demand)
    kept = [share.prod(axis=1)]
    for place in np.argsort(-weight, axis=None, kind="stable")[: 400 * most]:
        if len(kept) == most:
            break
        i, j, k = np.unravel_index(place, weight.shape)
        scale = x[i] * y[j] * z[k]
        if all(np.abs(scale - other).max(initial=0.0) > 0.08 for other in kept):
            kept.append(scale)
    return np.ascontiguousarray(np.array(kept).T)


def _weights(measured: Sequence[Floats], demand: Int64s) -> Floats:
    """Return the total under each triple of functions."""
    x, y, z = measured
    return np.array([(row * demand * y) @ z.T for row in x])
