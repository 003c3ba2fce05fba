"""Set covering over all builds that a search has met: the fewest that together hold every item."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.model.control import Stop

MOST_COLUMNS, ADDED, ROUNDS = 1500, 60, 100
"""Greatest numbers of builds in the integer program, of builds added in a round of pricing, and of rounds."""

NODES = 300
"""Nodes after which the branch and bound ends, so that the result does not depend on the clock."""

MARGIN = 1e-6


class Pool(NamedTuple):
    """Builds as sets of item types: ``(p + 1,)`` index at which each begins in `type_of` ``(t,)``."""

    start: Int64s
    type_of: Int64s

    def value(self, price: Floats) -> Floats:
        """Return the total price of each build, ``(p,)``."""
        return np.asarray(np.add.reduceat(price[self.type_of], self.start[:-1]))

    def counts(self, rows: Int64s, types: int) -> Floats:
        """Return the number of items of each type in the builds, ``(types, r)``."""
        held = [self.type_of[self.start[row] : self.start[row + 1]] for row in rows.tolist()]
        return np.array([np.bincount(types_held, minlength=types) for types_held in held], np.float64).T


def choose_builds(pool: Pool, demand: Int64s, first: Int64s, most: int, stop: Stop) -> Int64s | None:
    """Return at most `most` builds of the pool that together hold every item, or None if none are found.

    The fractional cover over the whole pool comes first: its value is a lower bound on every choice. Then the builds
    with the least reduced costs go into the integer program (HiGHS).

    Parameters
    ----------
    demand
        ``(types,)`` number of items of each type, each at least 1.
    first
        Numbers of builds of the pool that together hold every item.
    """
    rows, price, total = _fractional(pool, demand, first, stop)
    if total > most + MARGIN or stop():
        return None
    nearest = np.argsort(-pool.value(price), kind="stable")[:MOST_COLUMNS]
    chosen = np.unique(np.concatenate((rows, nearest)))
    found = _integer_cover(pool.counts(chosen, len(demand)), demand, stop.remaining())
    return None if found is None or found.sum() > most + 0.5 else np.repeat(chosen, found)


def _fractional(pool: Pool, demand: Int64s, first: Int64s, stop: Stop) -> tuple[Int64s, Floats, float]:
    """Return builds, dual values and value of the least fractional cover; pricing adds builds to it as needed."""
    from scipy.optimize import linprog

    rows = np.unique(first)
    for _ in range(ROUNDS):
        cover = -pool.counts(rows, len(demand))
        solved = linprog(np.ones(len(rows)), A_ub=cover, b_ub=-demand, method="highs")
        if not solved.success:
            return rows, np.zeros(len(demand)), np.inf
        price = np.maximum(-solved.ineqlin.marginals, 0.0)
        value = pool.value(price)
        new = np.argsort(-value, kind="stable")[:ADDED]
        new = new[value[new] > 1.0 + MARGIN]
        if not len(new) or stop():
            break
        rows = np.unique(np.concatenate((rows, new)))
    return rows, price, float(price @ demand)


def _integer_cover(counts: Floats, demand: Int64s, seconds: float) -> Int64s | None:
    """Return how often each build is used in the best integer cover found, or None."""
    from scipy.optimize import Bounds, LinearConstraint, milp

    columns = counts.shape[1]
    solved = milp(
        np.ones(columns),
        constraints=LinearConstraint(counts, lb=demand.astype(np.float64)),
        integrality=np.ones(columns, np.int64),
        bounds=Bounds(0.0, np.inf),
        options={"node_limit": NODES, "time_limit": max(min(seconds, 1e6), 1e-3)},
    )
    return None if solved.x is None else np.round(solved.x).astype(np.int64)
