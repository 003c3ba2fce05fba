"""The packer `ip`: the thesis's integer program, after a heuristic's packing."""

import math
from dataclasses import replace

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem, Status
from amprep.plugins.packers.bounds.volume import builds_bound, fill_bound
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.instance.arrangement import (
    Arrangement,
    arrangement_of,
    builds_of,
    left_out,
    value_of,
)
from amprep.plugins.packers.instance.prepare import Scene, prepare
from amprep.plugins.packers.integer_program.data import Ground, count_directions, prepare_ground
from amprep.plugins.packers.integer_program.decode import read_arrangement, start_values
from amprep.plugins.packers.integer_program.model import make_program, value_unit
from amprep.plugins.packers.integer_program.solver import TOLERANCE, Outcome, solve
from amprep.plugins.packers.params import ExtremePointsParams, IpParams


def pack_ip(
    problem: PackingProblem,
    *,
    params: IpParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack by the integer program of thesis 2.2, boxes of one item by substitution (2.3).

    The packing by extreme points comes first. In a fill problem the solver starts from it; in a builds
    problem it is asked for one build fewer, so that *infeasible* is the proof. Bounds of the program are
    passed on without clearance only, for with it the program asks for more than the judge does at corners.
    Proofs hold to within the solver's tolerances.
    """
    known = pack_extreme_points(problem, params=ExtremePointsParams(), rng=rng, stop=stop, progress=progress)
    scene = prepare(problem)
    if settled(scene, known, stop):
        return known
    filling = problem.objective == "fill"
    directions = count_directions(scene, params)
    if directions > params.directions:
        return replace(known, stop_reason=too_many(directions, params))
    progress(0.0, "building the model")
    ground = prepare_ground(scene, 1 if filling else len(known.builds) - 1, params)
    program, variables = make_program(ground, params)
    arrangement = arrangement_of(scene, known)
    outcome = solve(
        program,
        params,
        nodes=node_budget(directions, params),
        stop=stop,
        progress=progress,
        start=start_values(ground, variables, arrangement) if filling else None,
    )
    found = read_arrangement(ground, variables) if outcome.solved else None
    if found is not None and better(scene, found, arrangement):
        arrangement = found
    packing = as_packing(scene, arrangement, proved_bound(ground, outcome), outcome.stop_reason)
    progress(1.0, f"gap {gap_of(packing, problem):.1%}")
    return packing


def settled(scene: Scene, known: Packing, stop: Stop) -> bool:
    """Whether a heuristic's packing is all there is: the best one, nothing to pack, or no time left."""
    in_time = all(unplaced.reason != "out of time" for unplaced in known.unplaced)
    filling = scene.problem.objective == "fill"
    # one build cannot become fewer; that of the fixed items alone is there anyway
    least = not filling and len(known.builds) <= 1
    return known.status == "optimal" or stop() or not scene.free.any() or not in_time or least


def too_many(directions: int, params: IpParams) -> str:
    """Return the stop reason of a program too large to build."""
    return f"model too large: {directions} direction variables, at most {params.directions}"


def node_budget(directions: int, params: IpParams) -> int:
    """Return how many branch-and-bound nodes the effort allows."""
    return math.ceil(params.effort * 1e6 / max(directions, 1))


def better(scene: Scene, found: Arrangement, known: Arrangement) -> bool:
    """Whether an arrangement beats another one that is valid."""
    if scene.problem.objective == "fill":
        return value_of(scene, found) > value_of(scene, known)
    return int(found.build.max(initial=-1)) < int(known.build.max(initial=-1))


def proved_bound(ground: Ground, outcome: Outcome) -> float:
    """Return what no packing can beat, by the combinatorial bound and what the solver proved."""
    scene, filling = ground.scene, ground.filling
    plain = fill_bound(scene) if filling else float(max(builds_bound(scene), 1))
    if scene.problem.clearance > 0.0:
        return plain
    if filling:
        fixed = sum(scene.problem.items[placement.item].value for placement in scene.problem.fixed)
        return plain if outcome.bound is None else min(plain, outcome.bound * value_unit(ground) + fixed)
    if outcome.status == "infeasible":
        return float(ground.builds + 1)
    return max(plain, math.ceil((outcome.bound or 0.0) - 10.0 * TOLERANCE))


def as_packing(scene: Scene, arrangement: Arrangement, bound: float, stop_reason: str) -> Packing:
    """Return an arrangement with its bound as a packing; a gap within the solver's tolerance is closed."""
    builds, unplaced = builds_of(scene, arrangement), left_out(scene, arrangement, "no room left")
    status: Status = "feasible"
    if scene.problem.objective == "fill":
        value = value_of(scene, arrangement)
        if bound <= value * (1.0 + TOLERANCE):
            bound, status = value, "optimal"
    elif scene.too_large.any():
        status = "infeasible"
    elif len(builds) <= bound:
        status = "optimal"
    return Packing(builds, unplaced, bound, status, stop_reason)


def gap_of(packing: Packing, problem: PackingProblem) -> float:
    """Return how far the packing may be from the best one, as a share of the bound."""
    if packing.bound is None or packing.bound == 0.0:
        return 0.0
    placed = [placement.item for build in packing.builds for placement in build]
    reached = (
        sum(problem.items[item].value for item in placed)
        if problem.objective == "fill"
        else float(len(packing.builds))
    )
    return abs(packing.bound - reached) / abs(packing.bound)
