"""What guided searches for layouts share: their rules, the growth of weights, and steps of descents and scans.

After Voudouris, Tsang 1999 (doi:10.1016/S0377-2217(98)00099-X) and Umetani et al. 2009
(doi:10.1111/j.1475-3995.2009.00707.x).
"""

from typing import NamedTuple

from amprep.arrays import Int64s
from amprep.kernels.helper import helper

EVERYWHERE = -1
"""Build of an obstacle that is in every build."""

READ, MOVES, SCANS, ROUNDS = range(4)
"""Columns of the work that a search has spent: field values read or computed, moves, scans, rounds."""

NEGLIGIBLE = 1e-9
"""Weighted overlap that counts as none."""

LONGER, SHORTER, TRIES = 1.3, 0.55, 2
"""Factors of the step of a descent after a success, and after so many failures."""

VALUES_A_DEPTH = 8
"""Field values read for one depth between samples."""


class MoveRules(NamedTuple):
    """Rules of a guided search.

    Attributes
    ----------
    first, end
        ``(n,)`` range of the shapes that an item may have.
    builds
        Number of builds.
    scan_chance
        Probability that a move scans a build when descent alone leaves an overlap.
    finest
        Step (mm) at which a descent ends.
    enough
        Total overlap (mm) at which the search ends.
    """

    first: Int64s
    end: Int64s
    builds: int
    scan_chance: float
    finest: float
    enough: float


class WeightGrowth(NamedTuple):
    """Factors of the weights of overlaps after each round: of the least and of the deepest one, and of pairs apart."""

    least: float
    most: float
    decay: float


@helper
def new_weight(weight, depth, deepest, growth):
    """Return the weight of a pair after a round: more if it overlaps, in proportion to its depth, else nearer to 1."""
    if depth > 1e-6:
        return weight * (growth.least + (growth.most - growth.least) * depth / deepest)
    return max(1.0, weight * growth.decay)


@helper
def clamped(value, start, reach, lo, hi):
    """Return a coordinate moved into a range and to at most a reach from the start of a descent."""
    return min(max(value, lo, start - reach), hi, start + reach)


@helper
def keep_best(cell, value, count, where, least):
    """Insert a cell into the best ones, which are sorted by their values, best first; return their number."""
    if count < cell.size:
        k = count
        count += 1
    elif least < value[count - 1]:
        k = count - 1
    else:
        return count
    while k > 0 and value[k - 1] > least:
        value[k], cell[k] = value[k - 1], cell[k - 1]
        k -= 1
    value[k], cell[k] = least, where
    return count
