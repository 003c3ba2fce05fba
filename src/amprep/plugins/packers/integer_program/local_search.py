"""The packer `ip-local-search`: steps to the best arrangement near the last one, by the integer program."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pulp

from amprep.arrays import Bools
from amprep.kernels.boxes.records import Arrangement
from amprep.model.control import Progress, Stop, silent
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing, value_of
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare
from amprep.plugins.packers.integer_program import (
    NOT_RUN,
    NOTHING_BETTER,
    SOLVER,
    closed_bound,
    is_final,
    node_budget,
    proved_bound,
    too_many,
)
from amprep.plugins.packers.integer_program.constraints import make_program
from amprep.plugins.packers.integer_program.data import ModelData, count_directions, prepare_model_data
from amprep.plugins.packers.integer_program.decode import (
    canonical,
    holding,
    read_arrangement,
    start_values,
)
from amprep.plugins.packers.integer_program.solver import TOLERANCE, solve
from amprep.plugins.packers.integer_program.variables import Constraint, Program
from amprep.plugins.packers.integer_program.warm_start import heuristic_packing
from amprep.plugins.packers.params import IpLocalSearchParams


@dataclass(frozen=True, eq=False)
class Neighbourhood:
    """The arrangements near an old one.

    Attributes
    ----------
    used
        True for each copy of an item that is used in the old arrangement.
    holding
        Directions ``(6,)`` that hold in the old arrangement, for each pair of boxes.
    used_distance, direction_distance
        Greatest number of *used* variables and of directions that may differ.
    """

    used: tuple[bool, ...]
    holding: tuple[Bools, ...]
    used_distance: int
    direction_distance: int

    def used_near(self, program: Program) -> Iterator[Constraint]:
        """Let at most `used_distance` of the *used* variables differ from the old ones."""
        terms = [
            1 - program.variables.used(copy) if used else program.variables.used(copy)
            for copy, used in enumerate(self.used)
        ]
        yield pulp.lpSum(terms) <= self.used_distance

    def directions_near(self, program: Program) -> Iterator[Constraint]:
        """Let at most `direction_distance` directions differ, over pairs of which both are used before and after.

        The thesis writes ``front_new - used_old`` and ``used_new - used_old`` for the last two of the six terms; front
        and back are meant: each of the six is compared with its own old value. It counts only objects that are used.
        An item that enters therefore costs nothing, and neither does one that leaves: the number of changes of a pair
        is a variable, which may be 0 when one of its boxes is not used any more. An old direction is 0 when it holds
        in space, else 1.
        """
        data, variables = program.data, program.variables
        changes = []
        for number, (pair, held, new) in enumerate(
            zip(data.pairs, self.holding, variables.direction, strict=True)
        ):
            both = pair.other.copy < 0 or self.used[pair.other.copy]
            if self.used[pair.one.copy] and both:
                terms = [
                    variable if old else 1 - variable
                    for variable, old in zip(new, held.tolist(), strict=True)
                    if variable is not None
                ]
                left = 1 - variables.used(pair.one.copy)
                if pair.other.copy >= 0:
                    left += 1 - variables.used(pair.other.copy)
                changed = program.problem.add_variable(f"changed_{number}", 0, len(terms))
                changes.append(changed)
                yield pulp.lpSum(terms) - len(terms) * left <= changed
        yield pulp.lpSum(changes) <= self.direction_distance

    def covers(self, data: ModelData) -> bool:
        """Return whether every arrangement is in the neighbourhood."""
        everything = self.used_distance >= len(self.used)
        return everything and self.direction_distance >= 6 * len(data.pairs)


def neighbourhood(
    data: ModelData, old: Arrangement, used_distance: int, direction_distance: int
) -> Neighbourhood:
    """Return the neighbourhood of an arrangement in the canonical form of the program."""
    old = canonical(data, old)
    used = tuple(
        bool(old.build[copy.item] >= 0 and old.orientation[copy.item] in copy.orientations)
        for copy in data.copies
    )
    return Neighbourhood(
        used, tuple(holding(data, old, pair) for pair in data.pairs), used_distance, direction_distance
    )


def pack_ip_local_search(
    problem: PackingProblem,
    *,
    params: IpLocalSearchParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Fill a build by local search with the integer program (thesis 2.2)."""
    instance = prepare(problem)
    return as_packing(instance, search_near(instance, params=params, rng=rng, stop=stop, progress=progress))


def search_near(
    instance: PreparedInstance,
    *,
    params: IpLocalSearchParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Return the last arrangement of the local search, which starts from that of a heuristic.

    Each step solves the program of `ip` restricted to the neighbourhood of the last arrangement; where that has
    nothing better, the neighbourhood grows. Each step gets an equal part of the effort and time that are left. The
    bound of the program counts only if a neighbourhood has grown to hold every arrangement.
    """
    known = heuristic_packing(instance, params, rng, stop, progress)
    if is_final(instance, known, stop):
        return known._replace(found_by=f"{known.found_by}; {NOT_RUN}")
    directions = count_directions(instance, params)
    if directions > params.directions:
        return known._replace(
            stop_reason=too_many(directions, params), found_by=f"{known.found_by}; {NOT_RUN}"
        )
    data = prepare_model_data(instance, 1, params, stop)
    best, bound, reason = known.arrangement, known.bound, "finished"
    found_by = f"{known.found_by}; {NOTHING_BETTER}"
    used_distance, direction_distance = params.used_distance, params.direction_distance
    budget = node_budget(directions, params)
    for step in range(params.steps):
        progress(step / params.steps, f"value {value_of(instance, best):g}")
        near = neighbourhood(data, best, used_distance, direction_distance)
        program, variables = make_program(data, params, stop, (near.used_near, near.directions_near))
        start = start_values(data, variables, best, stop)
        left = params.steps - step
        nodes, in_time = math.ceil(budget / left), stop.within(_part(stop.remaining(), left))
        outcome = solve(program, params, nodes=nodes, stop=in_time, progress=silent, start=start)
        budget -= max(outcome.nodes, 1)
        found = read_arrangement(data, variables) if outcome.solved else None
        improved = found is not None and value_of(instance, found) > value_of(instance, best)
        if found is not None and improved:
            best, found_by = found, f"{SOLVER} {params.solver}"
        if near.covers(data):
            bound = min(bound, proved_bound(data, outcome))
        if stop() or budget <= 0:
            reason = stop.reason if stop() else "work used up"
            break
        met = value_of(instance, best) >= bound * (1.0 - TOLERANCE)
        if met or (not improved and (near.covers(data) or params.growth == 1.0)):
            break
        if not improved:
            used_distance = max(used_distance + 1, int(used_distance * params.growth))
            direction_distance = max(direction_distance + 1, int(direction_distance * params.growth))
    else:
        reason = "work used up"
    return PackerResult(best, closed_bound(instance, best, bound), reason, found_by=found_by)


def _part(seconds: float, steps: int) -> float | None:
    """Return the seconds for one of the steps; None without a limit."""
    return seconds / steps if math.isfinite(seconds) else None
