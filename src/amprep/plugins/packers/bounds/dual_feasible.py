"""Bounds by conservative scales, which are products of dual feasible functions of the box sides.

A dual feasible function u maps [0, 1] to [0, 1] so that numbers whose sum is at most 1 are mapped to numbers whose sum
is at most 1. When the sides along each axis are measured by such a function, the boxes of a build still have a total
volume of at most 1 (Fekete and Schepers, *A general framework for bounds for higher-dimensional
orthogonal packing problems*, Mathematical Methods of Operations Research 60 (2004),
doi:10.1007/s001860400376).
"""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats, Int64s

ROUNDING = 1e-12
MOST_CUTS, FEWEST_CUTS, MANY = 20, 3, 1000
"""Most and fewest thresholds per axis, and the number of item types from which there are fewer of them: volume bounds
many small boxes well."""

MULTIPLES = np.arange(2.0, 7.0)
"""The values of k + 1 for the functions u^(k)."""


def measures(length: Floats) -> Floats:
    """Return lengths ``(k,)``, as fractions of the room, under each dual feasible function, ``(f, k)``.

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
    """Return thresholds up to 1/2 at which the functions change, evenly chosen when there are too many."""
    cuts = np.concatenate((length, 1.0 - length))
    cuts = cuts[np.unique(np.round(cuts, 12), return_index=True)[1]]
    cuts = cuts[(cuts > 1e-6) & (cuts <= 0.5 + ROUNDING)]
    most = max(FEWEST_CUTS, min(MOST_CUTS, MOST_CUTS * MANY // max(len(length), 1)))
    if len(cuts) > most:
        cuts = cuts[np.linspace(0, len(cuts) - 1, most).astype(int)]
    return np.asarray(cuts)


def _rounded(length: Floats, cut: Floats) -> Floats:
    """Return f_2 for each cut ``(c, 1)``: small lengths in whole cuts, large lengths by the cuts beside them.

    The two sides of the inequality are rounded with different tolerances, so that rounding never proves too much.
    """
    cuts = np.floor(1.0 / cut + 1e-7)
    large = 2.0 * (cuts - np.floor((1.0 - length) / cut + 1e-7))
    small = 2.0 * np.floor(length / cut + 1e-10)
    half = np.abs(length - 0.5) <= ROUNDING
    return np.asarray(np.where(half, cuts, np.where(length > 0.5, large, small)) / (2.0 * cuts))


def greatest_scale(fraction: Floats, demand: Int64s) -> float:
    """Return the greatest total of the boxes under a conservative scale, a lower bound on the builds.

    Parameters
    ----------
    fraction
        ``(k, 3)`` sides of each item type as fractions of the room, at most 1.
    demand
        ``(k,)`` number of items of each type.
    """
    return float(_weights([measures(fraction[:, axis]) for axis in range(3)], demand).max(initial=0.0))


def greatest_scales(fraction: Floats, demand: Int64s, most: int) -> Floats:
    """Return the volume and the scales of greatest total, ``(k, s)``.

    Parameters
    ----------
    fraction, demand
        As in `greatest_scale`.
    most
        Greatest number of scales; any two differ by more than 0.08 for some item type.
    """
    x, y, z = (measures(fraction[:, axis]) for axis in range(3))
    weight = _weights([x, y, z], demand)
    kept = [fraction.prod(axis=1)]
    for flat in np.argsort(-weight, axis=None, kind="stable")[: 400 * most]:
        if len(kept) == most:
            break
        i, j, k = np.unravel_index(flat, weight.shape)
        scale = x[i] * y[j] * z[k]
        if all(np.abs(scale - other).max(initial=0.0) > 0.08 for other in kept):
            kept.append(scale)
    return np.ascontiguousarray(np.array(kept).T)


def _weights(measured: Sequence[Floats], demand: Int64s) -> Floats:
    """Return the total of the boxes under each triple of functions."""
    x, y, z = measured
    return np.array([(row * demand * y) @ z.T for row in x])
