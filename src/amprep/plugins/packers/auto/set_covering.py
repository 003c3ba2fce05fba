"""Set partitioning over every build a search has met: fewest of them that together hold everything."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.model.control import Stop

MOST_COLUMNS, ADDED, ROUNDS = 1500, 60, 100
"""Builds the whole-number program chooses from; builds added in a round of pricing, and such rounds."""

NODES = 300
"""Nodes of the branch and bound after which it ends, so that the answer does not depend on the clock."""

MOST_KINDS = 400
"""Kinds beyond which fractional covers take too long to be of use."""

MARGIN = 1e-6


class Pool(NamedTuple):
    """Builds by kinds: ``(p + 1,)`` where each begins in `kind` ``(t,)``."""

    start: Int64s
    kind: Int64s

    def worth(self, price: Floats) -> Floats:
        """Return the total price of each build, ``(p,)``."""
        return np.asarray(np.add.reduceat(price[self.kind], self.start[:-1]))

    def counts(self, rows: Int64s, kinds: int) -> Floats:
        """Return how many of each kind the builds hold, ``(kinds, r)``."""
        held = [self.kind[self.start[row] : self.start[row + 1]] for row in rows.tolist()]
        return np.array([np.bincount(kind, minlength=kinds) for kind in held], np.float64).T


def choose_builds(pool: Pool, demand: Int64s, first: Int64s, most: int, stop: Stop) -> Int64s | None:
    """Return at most `most` builds of the pool that hold every item, or None if none are found.

    The fractional cover over the whole pool comes first: where it needs more builds, no choice does with
    fewer. Then the builds nearest to being part of it go into the whole-number program (HiGHS).

    Parameters
    ----------
    demand
        ``(kinds,)`` items of each kind to be held, each at least 1.
    first
        Builds that together hold every item, numbers in the pool.
    """
    rows, price, total = _fractional(pool, demand, first, stop)
    if total > most + MARGIN or stop():
        return None
    nearest = np.argsort(-pool.worth(price), kind="stable")[:MOST_COLUMNS]
    chosen = np.unique(np.concatenate((rows, nearest)))
    found = _whole(pool.counts(chosen, len(demand)), demand, stop.remaining())
    return None if found is None or found.sum() > most + 0.5 else np.repeat(chosen, found)


def _fractional(pool: Pool, demand: Int64s, first: Int64s, stop: Stop) -> tuple[Int64s, Floats, float]:
    """Return the builds used, prices and value of the best fractional cover; builds are priced in as needed."""
    from scipy.optimize import linprog

    rows = np.unique(first)
    for _ in range(ROUNDS):
        cover = -pool.counts(rows, len(demand))
        solved = linprog(np.ones(len(rows)), A_ub=cover, b_ub=-demand, method="highs")
        if not solved.success:
            return rows, np.zeros(len(demand)), np.inf
        price = np.maximum(-solved.ineqlin.marginals, 0.0)
        worth = pool.worth(price)
        new = np.argsort(-worth, kind="stable")[:ADDED]
        new = new[worth[new] > 1.0 + MARGIN]
        if not len(new) or stop():
            break
        rows = np.unique(np.concatenate((rows, new)))
    return rows, price, float(price @ demand)


def _whole(counts: Floats, demand: Int64s, seconds: float) -> Int64s | None:
    """Return how often each build is used in the best whole cover found; None without one."""
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
