"""The packer `ip`: the integer program of the thesis, after a heuristic's packing."""

import math

import numpy as np

from amprep.kernels.boxes.records import Arrangement
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.bounds.combinatorial import packing_bound
from amprep.plugins.packers.instance.arrangement import (
    PackerResult,
    as_packing,
    builds_used,
    status_of,
    value_of,
)
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare
from amprep.plugins.packers.integer_program.constraints import make_program
from amprep.plugins.packers.integer_program.data import (
    ModelData,
    count_directions,
    keeps_corners_apart,
    prepare_model_data,
)
from amprep.plugins.packers.integer_program.decode import read_arrangement, start_values
from amprep.plugins.packers.integer_program.solver import TOLERANCE, Outcome, solve
from amprep.plugins.packers.integer_program.warm_start import heuristic_packing, without_start
from amprep.plugins.packers.params import IpParams

SOLVER = "the solver"
"""Beginning of `PackerResult.found_by` where the integer program found the arrangement."""

NOT_RUN, NOTHING_BETTER = "the solver did not run", "the solver found nothing better"
"""End of `PackerResult.found_by` where a heuristic found the arrangement."""


def pack_ip(
    problem: PackingProblem,
    *,
    params: IpParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack by the integer program of thesis 2.2; the boxes of one item are substituted as in 2.3."""
    instance = prepare(problem)
    return as_packing(
        instance, solve_instance(instance, params=params, rng=rng, stop=stop, progress=progress)
    )


def solve_instance(
    instance: PreparedInstance,
    *,
    params: IpParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Return the better one of a heuristic's arrangement and that of the integer program.

    In a fill problem the solver starts from the heuristic's arrangement. In a builds problem it gets one build fewer,
    until none is found, so that *infeasible* is the proof. With clearance the relaxed program is solved first, because
    only it admits every packing that the judge accepts and so proves bounds; where its arrangement cannot keep the
    clearance, the exact program follows. Proofs hold to within the tolerances of the solver.
    """
    known = heuristic_packing(instance, params, rng, stop, progress)
    if is_final(instance, known, stop):
        return known._replace(found_by=f"{known.found_by}; {NOT_RUN}")
    directions = count_directions(instance, params)
    if directions > params.directions:
        reason = too_many(directions, params)
        return known._replace(stop_reason=reason, found_by=f"{known.found_by}; {NOT_RUN}")
    best = without_start(known) if instance.filling and params.start == "none" else known
    nodes = node_budget(directions, params)
    while True:
        builds = best.arrangement.builds
        best, nodes = solve_round(instance, best, params, nodes, stop, progress)
        if instance.filling or best.arrangement.builds == builds or nodes <= 0:
            break
        if is_final(instance, best, stop):
            break
    best = best if best.arrangement.builds else known._replace(stop_reason=best.stop_reason, bound=best.bound)
    if not best.found_by.startswith(SOLVER):
        best = best._replace(found_by=f"{known.found_by}; {NOTHING_BETTER}")
    progress(1.0, f"gap {gap_of(instance, best):.1%}")
    return best


def solve_round(
    instance: PreparedInstance,
    known: PackerResult,
    params: IpParams,
    nodes: int,
    stop: Stop,
    progress: Progress,
) -> tuple[PackerResult, int]:
    """Solve the relaxed program where a clearance is kept, and the exact one unless the gap is closed then.

    The result is the better one, with the better bound, and the number of nodes that are left.
    """
    if keeps_corners_apart(instance):
        half = stop.within(None if stop.deadline is None else stop.remaining() / 2.0)
        known, used = improve(
            instance, known, params, relaxed=True, nodes=(nodes + 1) // 2, stop=half, progress=progress
        )
        nodes -= max(used, 1)
        if nodes <= 0 or is_final(instance, known, stop):
            return known, nodes
    known, used = improve(instance, known, params, relaxed=False, nodes=nodes, stop=stop, progress=progress)
    return known, nodes - max(used, 1)


def improve(
    instance: PreparedInstance,
    known: PackerResult,
    params: IpParams,
    *,
    relaxed: bool,
    nodes: int,
    stop: Stop,
    progress: Progress,
) -> tuple[PackerResult, int]:
    """Solve the program once; return the better result, with the better bound, and the nodes used."""
    progress(0.0, "building the model")
    builds = 1 if instance.filling else builds_used(instance, known.arrangement) - 1
    data = prepare_model_data(instance, builds, params, stop, relaxed=relaxed)
    program, variables = make_program(data, params, stop)
    warm = instance.filling and params.start != "none"
    start = start_values(data, variables, known.arrangement, stop) if warm else None
    outcome = solve(program, params, nodes=nodes, stop=stop, progress=progress, start=start)
    found = read_arrangement(data, variables) if outcome.solved else None
    bound = max(known.bound, proved_bound(data, outcome))
    if instance.filling:
        bound = min(known.bound, proved_bound(data, outcome))
    if found is not None and _is_better(instance, found, known.arrangement):
        known = known._replace(arrangement=found, found_by=f"{SOLVER} {params.solver}")
    bound = closed_bound(instance, known.arrangement, bound)
    return known._replace(bound=bound, stop_reason=outcome.stop_reason), outcome.nodes


def is_final(instance: PreparedInstance, known: PackerResult, stop: Stop) -> bool:
    """Return whether a heuristic's result stays: it is optimal, nothing is to be packed, or no time is left."""
    # one build cannot become fewer, and the build of fixed items is always there
    least = not instance.filling and builds_used(instance, known.arrangement) <= 1
    optimal = status_of(instance, known) == "optimal"
    return optimal or stop() or not instance.free.any() or not known.complete or least


def too_many(directions: int, params: IpParams) -> str:
    """Return the stop reason for a program that is too large to build."""
    return f"model too large: {directions} direction variables, at most {params.directions}"


def node_budget(directions: int, params: IpParams) -> int:
    """Return the number of branch-and-bound nodes that the effort allows."""
    return math.ceil(params.effort * 1e6 / max(directions, 1))


def _is_better(instance: PreparedInstance, found: Arrangement, known: Arrangement) -> bool:
    """Return whether an arrangement is better than a known valid one."""
    if instance.filling:
        return value_of(instance, found) > value_of(instance, known)
    return found.builds < known.builds


def proved_bound(data: ModelData, outcome: Outcome) -> float:
    """Return the better one of the combinatorial bound and the bound of the solver."""
    instance = data.instance
    plain = packing_bound(instance) if instance.filling else max(packing_bound(instance), 1.0)
    if not data.proves:
        return plain
    if instance.filling:
        fixed = sum(instance.problem.items[placement.item].value for placement in instance.problem.fixed)
        return plain if outcome.bound is None else min(plain, outcome.bound * data.value_unit + fixed)
    if outcome.status == "infeasible":
        return float(data.builds + 1)
    return max(plain, math.ceil((outcome.bound or 0.0) - 10.0 * TOLERANCE))


def closed_bound(instance: PreparedInstance, arrangement: Arrangement, bound: float) -> float:
    """Return the bound of a fill problem, or the value reached where the gap is within the solver's tolerance."""
    value = value_of(instance, arrangement) if instance.filling else -math.inf
    return value if bound <= value * (1.0 + TOLERANCE) else bound


def gap_of(instance: PreparedInstance, result: PackerResult) -> float:
    """Return the gap between the result and its bound, as a fraction of the bound."""
    if result.bound == 0.0:
        return 0.0
    if instance.filling:
        reached = value_of(instance, result.arrangement)
    else:
        reached = float(builds_used(instance, result.arrangement))
    return abs(result.bound - reached) / abs(result.bound)
