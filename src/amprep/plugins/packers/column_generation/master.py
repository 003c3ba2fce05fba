"""The set covering over builds: its fractional optimum with dual values, and an integer cover."""

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


class FractionalCover(NamedTuple):
    """The fractional optimum.

    Attributes
    ----------
    fraction
        ``(columns,)`` number of times that each column is used.
    price
        ``(types,)`` dual values, at least 0: the cost of one more item of each type, in builds.
    """

    fraction: Floats
    price: Floats


def fractional_cover(columns: Sequence[Column], demand: Int64s, params: IpParams) -> FractionalCover:
    """Return the least fractional cover of the demand by builds.

    Raises
    ------
    AmprepError
        If the solver gives no optimum.
    """
    problem, uses, covers = _cover(columns, demand, pulp.LpContinuous)
    options = {"threads": params.threads} if params.solver == "HiGHS" else {}
    problem.solve(installed_solver(params.solver, **options))
    if problem.status != pulp.LpStatusOptimal or any(cover.pi is None for cover in covers.values()):
        raise AmprepError(
            f"the solver {params.solver} gave no dual values; choose another one, for example HiGHS"
        )
    price = np.zeros(len(demand))
    for item_type, cover in covers.items():
        price[item_type] = max(float(cover.pi), 0.0)
    return FractionalCover(np.array([use.varValue for use in uses], float), price)


def integer_cover(
    columns: Sequence[Column], demand: Int64s, params: IpParams, stop: Stop
) -> list[Column] | None:
    """Return the fewest columns that hold every item, as far as the effort allows; None if no cover was found."""
    problem, uses, _ = _cover(columns, demand, pulp.LpInteger)
    nodes = int(params.effort * 1e6 / max(len(columns), 1)) + 1
    if not solve(problem, params, nodes=nodes, stop=stop, progress=silent).solved:
        return None
    times = [round(use.varValue) for use in uses]
    return [column for column, n in zip(columns, times, strict=True) for _ in range(n)]


def _cover(
    columns: Sequence[Column], demand: Int64s, category: str
) -> tuple[pulp.LpProblem, list[Any], dict[int, Any]]:
    """Return the covering problem, a variable per column, and a constraint per item type to be placed."""
    problem = pulp.LpProblem("cover", pulp.LpMinimize)
    uses = [problem.add_variable(f"use_{n}", 0, None, category) for n in range(len(columns))]
    problem.setObjective(pulp.lpSum(uses))
    counts = np.array([column.counts(len(demand)) for column in columns])
    covers = {}
    for item_type in np.flatnonzero(demand).tolist():
        held = np.flatnonzero(counts[:, item_type]).tolist()
        row = pulp.LpAffineExpression([(uses[n], int(counts[n, item_type])) for n in held])
        covers[item_type] = row >= int(demand[item_type])
        problem.addConstraint(covers[item_type], f"hold_{item_type}")
    return problem, uses, covers
