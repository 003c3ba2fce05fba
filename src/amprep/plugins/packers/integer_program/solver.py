"""Solve a program by HiGHS or any other solver of pulp, with bound, budget and cancellation."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import highspy
import numpy as np
import pulp

from amprep.arrays import Floats
from amprep.errors import AmprepError, nearest_hint
from amprep.model.control import Progress, Stop
from amprep.plugins.packers.params import IpParams

Proof = Literal["optimal", "infeasible", "stopped"]

TOLERANCE = 1e-6
"""Tolerance of integers, constraints and gaps."""


@dataclass(frozen=True)
class Outcome:
    """The result of a solver.

    Attributes
    ----------
    status
        ``optimal``, ``infeasible``, or ``stopped`` when it ended without a proof.
    bound
        Proven bound of the objective; None when the solver reports none.
    solved
        Whether the variables hold a solution.
    stop_reason
        Why the solver ended.
    nodes
        Branch-and-bound nodes used.
    """

    status: Proof
    bound: float | None
    solved: bool
    stop_reason: str
    nodes: int = 0


def solve(
    program: pulp.LpProblem,
    params: IpParams,
    *,
    nodes: int,
    stop: Stop,
    progress: Progress,
    start: Mapping[Any, float] | None = None,
) -> Outcome:
    """Solve a program; its variables hold the solution afterwards.

    Parameters
    ----------
    nodes
        Greatest number of branch-and-bound nodes.
    start
        Warm start: values of the variables; an infeasible one is ignored.

    Raises
    ------
    AmprepError
        If pulp does not know the solver, or it is not installed or fails.
    """
    if stop():
        return Outcome("stopped", None, solved=False, stop_reason=stop.reason)
    if params.solver == "HiGHS":
        return _solve_by_highs(program, params, nodes, stop, progress, start or {})
    return _solve_by_name(program, params.solver, stop)


def _solve_by_highs(
    program: pulp.LpProblem,
    params: IpParams,
    nodes: int,
    stop: Stop,
    progress: Progress,
    start: Mapping[Any, float],
) -> Outcome:
    """Solve by HiGHS through its own interface, because pulp passes on neither a warm start nor the bound."""
    callbacks = highspy.cb.HighsCallbackType

    def inspect(_type: Any, _message: str, at: Any, answer: Any, _own: Any) -> None:
        progress(min(at.mip_node_count / max(nodes, 1), 1.0), f"gap {at.mip_gap:.1%}")
        if stop():
            answer.user_interrupt = True

    solver = pulp.HiGHS(
        msg=False,
        threads=params.threads,
        gapRel=TOLERANCE,
        gapAbs=TOLERANCE,
        random_seed=params.seed,
        mip_allow_restart=False,  # a restart may take longer than a small budget of nodes
        mip_max_nodes=nodes,
        mip_feasibility_tolerance=TOLERANCE / 100.0,
        callbackTuple=(inspect, None),
        callbacksToActivate=[callbacks.kCallbackMipInterrupt],
    )
    solver.createAndConfigureSolver(program)
    highs, variables = program.solverModel, program.variables()
    model = _model_of(program, variables, stop)
    if model is None:
        return Outcome("stopped", None, solved=False, stop_reason=stop.reason)
    highs.passModel(model)
    if stop.deadline is not None:
        highs.setOptionValue("time_limit", max(stop.remaining(), 0.0))
    if start:
        known = highspy.HighsSolution()
        known.col_value = [float(start.get(variable, 0.0)) for variable in variables]
        highs.setSolution(known)
    highs.run()
    return _outcome_of_highs(program, variables, stop)


def _model_of(program: pulp.LpProblem, variables: list[Any], stop: Stop) -> Any:
    """Return the program as HiGHS reads it, a matrix by rows; None when told to stop.

    A maximised objective is negated. Strategy: pulp hands over row by row and cannot be interrupted, which takes
    seconds for large programs. Here the rows are collected in lists and passed on at once.
    """
    number = {variable: n for n, variable in enumerate(variables)}
    sign = -1.0 if program.sense == pulp.LpMaximize else 1.0
    start, index, value = [0], [], []
    lower, upper = [], []
    for row in program.constraints():
        if stop():
            return None
        for variable, factor in row.items():
            if factor:
                index.append(number[variable])
                value.append(float(factor))
        start.append(len(index))
        lower.append(row.getLb())
        upper.append(row.getUb())
    model = highspy.HighsLp()
    model.num_col_, model.num_row_ = len(variables), len(lower)
    model.col_cost_ = np.array([sign * program.objective.get(variable, 0.0) for variable in variables])
    model.col_lower_ = _bounds([variable.lowBound for variable in variables], -highspy.kHighsInf)
    model.col_upper_ = _bounds([variable.upBound for variable in variables], highspy.kHighsInf)
    model.row_lower_, model.row_upper_ = (
        _bounds(lower, -highspy.kHighsInf),
        _bounds(upper, highspy.kHighsInf),
    )
    model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    model.a_matrix_.start_, model.a_matrix_.index_ = np.array(start), np.array(index)
    model.a_matrix_.value_ = np.array(value)
    kinds = highspy.HighsVarType
    model.integrality_ = [
        kinds.kInteger if variable.cat == pulp.LpInteger else kinds.kContinuous for variable in variables
    ]
    return model


def _bounds(values: list[float | None], missing: float) -> Floats:
    """Return bounds as an array, with `missing` where there is none."""
    return np.array([missing if value is None else value for value in values], np.float64)


def _outcome_of_highs(program: pulp.LpProblem, variables: list[Any], stop: Stop) -> Outcome:
    """Return the outcome; HiGHS minimises, so a maximised objective was negated for it."""
    highs, statuses = program.solverModel, highspy.HighsModelStatus
    status, info = highs.getModelStatus(), highs.getInfo()
    reasons = {
        statuses.kOptimal: "finished",
        statuses.kInfeasible: "finished",
        statuses.kSolutionLimit: "work used up",
        statuses.kTimeLimit: "time limit",
        statuses.kInterrupt: stop.reason,
    }
    solved = info.primal_solution_status == highspy.SolutionStatus.kSolutionStatusFeasible
    for variable, value in zip(variables, highs.getSolution().col_value if solved else (), strict=False):
        variable.varValue = value
    sign = -1.0 if program.sense == pulp.LpMaximize else 1.0
    bound = sign * float(info.mip_dual_bound)
    return Outcome(
        "optimal"
        if status == statuses.kOptimal
        else "infeasible"
        if status == statuses.kInfeasible
        else "stopped",
        bound if abs(bound) < highspy.kHighsInf else None,
        solved,
        reasons.get(status, f"HiGHS: {highs.modelStatusToString(status)}"),
        max(int(info.mip_node_count), 0),
    )


def _solve_by_name(program: pulp.LpProblem, name: str, stop: Stop) -> Outcome:
    """Solve by any solver of pulp; only an optimum gives a bound."""
    limit = None if stop.deadline is None else max(stop.remaining(), 1.0)
    try:
        status = program.solve(installed_solver(name, limit))
    except pulp.PulpSolverError as error:
        raise AmprepError(
            f"the solver {name} failed: {error}; choose another one, for example HiGHS"
        ) from error
    if status == pulp.LpStatusInfeasible:
        return Outcome("infeasible", None, solved=False, stop_reason="finished")
    solved = program.sol_status in {pulp.LpSolutionOptimal, pulp.LpSolutionIntegerFeasible}
    if program.sol_status == pulp.LpSolutionOptimal:
        return Outcome("optimal", float(pulp.value(program.objective)), solved, "finished")
    return Outcome("stopped", None, solved, "time limit")


def installed_solver(name: str, time_limit: float | None = None, **options: Any) -> Any:
    """Return the silent solver of that name; `options` are passed on to it.

    Raises
    ------
    AmprepError
        If pulp does not know the solver, or it is not installed.
    """
    if name not in pulp.listSolvers():
        raise AmprepError(f"pulp knows no solver {name!r}{nearest_hint(name, pulp.listSolvers())}")
    solver = pulp.getSolver(name, msg=False, timeLimit=time_limit, **options)
    if not solver.available():
        known = ", ".join(pulp.listSolvers(onlyAvailable=True))
        raise AmprepError(f"the solver {name} is not installed; choose one of {known}")
    return solver
