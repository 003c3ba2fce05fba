"""The set covering over builds: its fractional optimum with dual values, and a cover in whole builds."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pulp

from amprep.arrays import Floats, Int64s
from amprep.errors import AmprepError
from amprep.model.control import Stop, silent
from amprep.plugins.packers.column_generation.columns import Column
from amprep.plugins.packers.integer_program.solver import installed_solver, solve
from amprep.plugins.packers.params import IpParams


class Fractional(NamedTuple):
    """The fractional optimum.

    Attributes
    ----------
    share
        Per column.
    price
        ``(kinds,)`` dual values, at least 0: what one more item of a kind would cost in builds.
    """

    share: Floats
    price: Floats


def fractional_cover(columns: Sequence[Column], demand: Int64s, params: IpParams) -> Fractional:
    """Return the least total of shares of builds that hold every item.

    Raises
    ------
    AmprepError
        If the solver gives no optimum.
    """
    problem, shares, covers = _cover(columns, demand, pulp.LpContinuous)
    options = {"threads": params.threads} if params.solver == "HiGHS" else {}
    problem.solve(installed_solver(params.solver, **options))
    if problem.status != pulp.LpStatusOptimal or any(cover.pi is None for cover in covers.values()):
        raise AmprepError(
            f"the solver {params.solver} gave no dual values; choose another one, for example HiGHS"
        )
    price = np.zeros(len(demand))
    for kind, cover in covers.items():
        price[kind] = max(float(cover.pi), 0.0)
    return Fractional(np.array([share.varValue for share in shares], float), price)


def whole_cover(
    columns: Sequence[Column], demand: Int64s, params: IpParams, stop: Stop
) -> list[Column] | None:
    """Return the fewest columns that hold every item, as far as the effort goes; None if none were found."""
    problem, shares, _ = _cover(columns, demand, pulp.LpInteger)
    nodes = int(params.effort * 1e6 / max(len(columns), 1)) + 1
    if not solve(problem, params, nodes=nodes, stop=stop, progress=silent).solved:
        return None
    times = [round(share.varValue) for share in shares]
    return [column for column, n in zip(columns, times, strict=True) for _ in range(n)]


def _cover(
    columns: Sequence[Column], demand: Int64s, category: str
) -> tuple[pulp.LpProblem, list[Any], dict[int, Any]]:
    """Return the covering problem, a variable per column and a constraint per kind to be placed."""
    problem = pulp.LpProblem("cover", pulp.LpMinimize)
    shares = [problem.add_variable(f"share_{n}", 0, None, category) for n in range(len(columns))]
    problem.setObjective(pulp.lpSum(shares))
    counts = np.array([column.counts(len(demand)) for column in columns])
    covers = {}
    for kind in np.flatnonzero(demand).tolist():
        held = np.flatnonzero(counts[:, kind]).tolist()
        row = pulp.LpAffineExpression([(shares[n], int(counts[n, kind])) for n in held])
        covers[kind] = row >= int(demand[kind])
        problem.addConstraint(covers[kind], f"hold_{kind}")
    return problem, shares, covers
