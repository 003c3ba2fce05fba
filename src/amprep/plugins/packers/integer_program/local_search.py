"""The packer `ip-local-search`: steps to the best arrangement near the last one, by the integer program."""

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
        """Let at most `direction_distance` directions differ, over pairs of which both are used in the old one.

        The thesis writes ``front_new - used_old`` and ``used_new - used_old`` for the last two of the six terms; front
        and back are meant: each of the six is compared with its own old value. It counts only objects that are used.
        Here that means used in the old arrangement, because the constraint is linear then, and an item that enters
        costs nothing. An old direction is 0 when it holds in space, else 1.
        """
        terms = []
        for pair, held, new in zip(
            program.data.pairs, self.holding, program.variables.direction, strict=True
        ):
            there = pair.other.copy < 0 or self.used[pair.other.copy]
            if self.used[pair.one.copy] and there:
                terms += [
                    variable if old else 1 - variable
                    for variable, old in zip(new, held.tolist(), strict=True)
                    if variable is not None
                ]
        yield pulp.lpSum(terms) <= self.direction_distance

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
    nothing better, the neighbourhood grows. The steps share the `effort`. The bound of the program counts only if a
    neighbourhood has grown to hold every arrangement.
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
        outcome = solve(program, params, nodes=budget, stop=stop, progress=silent, start=start)
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
