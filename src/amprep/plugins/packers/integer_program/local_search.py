"""The packer `ip-local-search`: steps to the best packing near the last one, by the integer program."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pulp

from amprep.arrays import Bools
from amprep.model.control import Progress, Stop, silent
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.bounds.volume import fill_bound
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.instance.arrangement import Arrangement, arrangement_of, value_of
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.integer_program import as_packing, node_budget, proved_bound, settled, too_many
from amprep.plugins.packers.integer_program.constraints import Constraint, Program
from amprep.plugins.packers.integer_program.data import Ground, count_directions, prepare_ground
from amprep.plugins.packers.integer_program.decode import (
    holding_directions,
    places_of,
    read_arrangement,
    start_values,
)
from amprep.plugins.packers.integer_program.model import make_program
from amprep.plugins.packers.integer_program.solver import TOLERANCE, solve
from amprep.plugins.packers.params import ExtremePointsParams, IpLocalSearchParams


@dataclass(frozen=True, eq=False)
class Neighbourhood:
    """The packings near an old one.

    Attributes
    ----------
    used
        Per body, whether it is used in the old packing.
    holding
        Per pair ``(6,)`` the directions that hold in it.
    """

    used: tuple[bool, ...]
    holding: tuple[Bools, ...]
    used_distance: int
    direction_distance: int

    def used_near(self, program: Program) -> Iterator[Constraint]:
        """Let at most `used_distance` of the used variables differ from the old ones."""
        terms = [
            1 - program.variables.used(body) if used else program.variables.used(body)
            for body, used in enumerate(self.used)
        ]
        yield pulp.lpSum(terms) <= self.used_distance

    def directions_near(self, program: Program) -> Iterator[Constraint]:
        """Let at most `direction_distance` directions differ, over pairs both used in the old packing.

        The thesis writes ``front_new - used_old`` and ``used_new - used_old`` for the last two of the six
        terms; front and back are meant: each of the six is compared with its own old value. It counts only
        objects that are used; that is read as used in the old packing, for then the constraint is linear, and
        an item that enters costs nothing. An old direction is 0 when it holds in space, else 1.
        """
        terms = []
        for pair, held, new in zip(
            program.ground.pairs, self.holding, program.variables.direction, strict=True
        ):
            there = pair.other.body < 0 or self.used[pair.other.body]
            if self.used[pair.one.body] and there:
                terms += [
                    variable if old else 1 - variable
                    for variable, old in zip(new, held.tolist(), strict=True)
                    if variable is not None
                ]
        yield pulp.lpSum(terms) <= self.direction_distance

    def covers(self, ground: Ground) -> bool:
        """Whether every packing is near."""
        everything = self.used_distance >= len(self.used)
        return everything and self.direction_distance >= 6 * len(ground.pairs)


def pack_ip_local_search(
    problem: PackingProblem,
    *,
    params: IpLocalSearchParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Fill a build by local search with the integer program (thesis 2.2).

    It starts from the packing by extreme points. Each step solves the program of `ip` narrowed to the
    neighbourhood of the last packing; where nothing better is in it, the neighbourhood grows. `effort` is
    shared by the steps. The bound is that of `ip` only if a neighbourhood came to hold every packing.
    """
    known = pack_extreme_points(problem, params=ExtremePointsParams(), rng=rng, stop=stop, progress=progress)
    scene = prepare(problem)
    if settled(scene, known, stop):
        return known
    directions = count_directions(scene, params)
    if directions > params.directions:
        return replace(known, stop_reason=too_many(directions, params))
    ground = prepare_ground(scene, 1, params)
    best, bound, reason = arrangement_of(scene, known), fill_bound(scene), "finished"
    used_distance, direction_distance = params.used_distance, params.direction_distance
    budget = node_budget(directions, params)
    for step in range(params.steps):
        progress(step / params.steps, f"value {value_of(scene, best):g}")
        near = neighbourhood(ground, best, used_distance, direction_distance)
        program, variables = make_program(ground, params, (near.used_near, near.directions_near))
        start = start_values(ground, variables, best)
        outcome = solve(program, params, nodes=budget, stop=stop, progress=silent, start=start)
        budget -= max(outcome.nodes, 1)
        found = read_arrangement(ground, variables) if outcome.solved else None
        improved = found is not None and value_of(scene, found) > value_of(scene, best)
        if found is not None and improved:
            best = found
        if near.covers(ground):
            bound = min(bound, proved_bound(ground, outcome))
        if stop() or budget <= 0:
            reason = stop.reason if stop() else "work used up"
            break
        met = value_of(scene, best) >= bound * (1.0 - TOLERANCE)
        if met or (not improved and (near.covers(ground) or params.growth == 1.0)):
            break
        if not improved:
            used_distance = max(used_distance + 1, int(used_distance * params.growth))
            direction_distance = max(direction_distance + 1, int(direction_distance * params.growth))
    else:
        reason = "work used up"
    return as_packing(scene, best, bound, reason)


def neighbourhood(
    ground: Ground, old: Arrangement, used_distance: int, direction_distance: int
) -> Neighbourhood:
    """Return the neighbourhood of a packing, seen as the program names and reflects it."""
    places = places_of(ground, old)
    used = tuple(
        places[body.item][0] >= 0 and places[body.item][1] in body.variants for body in ground.bodies
    )
    holding = tuple(holding_directions(ground, lambda item: places[item]))
    return Neighbourhood(used, holding, used_distance, direction_distance)
