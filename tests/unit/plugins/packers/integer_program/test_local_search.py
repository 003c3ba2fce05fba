"""The packer `ip-local-search`: its neighbourhoods are those of thesis 2.2, and steps never lose value."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.boxes import boxes_problem
from tests.shared.examples import examples

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Stop, silent
from amprep.plugins.packers.extreme_points import construct
from amprep.plugins.packers.instance.arrangement import value_of
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.integer_program import pack_ip
from amprep.plugins.packers.integer_program.constraints import make_program
from amprep.plugins.packers.integer_program.data import prepare_model_data
from amprep.plugins.packers.integer_program.decode import start_values
from amprep.plugins.packers.integer_program.local_search import neighbourhood, pack_ip_local_search
from amprep.plugins.packers.integer_program.solver import solve
from amprep.plugins.packers.params import ExtremePointsParams, IpLocalSearchParams, IpParams


def problem(sizes, room):
    return boxes_problem(sizes, room, objective="fill")


def value(given_problem, packing):
    return sum(given_problem.items[p.item].value for build in packing.builds for p in build)


def start(instance):
    rng = np.random.default_rng(1)
    found = construct(instance, params=ExtremePointsParams(), rng=rng, stop=Stop(), progress=silent)
    return found.arrangement


def search(given_problem, stop=None, **params):
    rng, chosen = np.random.default_rng(1), IpLocalSearchParams(**params)
    packing = pack_ip_local_search(
        given_problem, params=chosen, rng=rng, stop=stop or Stop(), progress=silent
    )
    assert check_packing(given_problem, packing) == []
    return packing


side = st.integers(1, 4)
some_sizes = st.lists(st.tuples(side, side, side), min_size=2, max_size=6)


@examples(40)
@given(some_sizes, st.integers(1, 3), st.integers(0, 12), st.booleans())
def test_one_step_changes_no_more_than_the_distances_allow(sizes, used_distance, direction_distance, tighten):
    given_problem = problem(sizes, 5)
    params, instance = IpLocalSearchParams(tighten=tighten), prepare(given_problem)
    data, old = prepare_model_data(instance, 1, params, Stop()), start(instance)
    near = neighbourhood(data, old, used_distance, direction_distance)
    program, variables = make_program(data, params, Stop(), (near.used_near, near.directions_near))
    values = start_values(data, variables, old, Stop())
    outcome = solve(program, params, nodes=2000, stop=Stop(), progress=silent, start=values)
    assert outcome.solved

    used = [round(inside[0].varValue) for inside in variables.inside]
    assert sum(new != was for new, was in zip(used, near.used, strict=True)) <= used_distance
    moved = 0
    for pair, held, directions in zip(data.pairs, near.holding, variables.direction, strict=True):
        one, other = pair.one.copy, pair.other.copy
        if near.used[one] and near.used[other] and used[one] and used[other]:
            old_values = [1 - int(h) for h in held]
            new_values = [1 if v is None else round(v.varValue) for v in directions]
            moved += sum(new != was for new, was in zip(new_values, old_values, strict=True))
    assert moved <= direction_distance


@examples(25)
@given(some_sizes)
def test_neighbourhoods_that_grow_to_everything_end_at_the_optimum(sizes):
    given_problem = problem(sizes, 5)
    rng = np.random.default_rng(1)
    best = pack_ip(given_problem, params=IpParams(effort=10.0), rng=rng, stop=Stop(), progress=silent)
    packing = search(given_problem, effort=10.0, growth=10.0)
    assert best.status == packing.status == "optimal"
    assert value(given_problem, packing) == value(given_problem, best)


@pytest.mark.parametrize(("used_distance", "direction_distance"), [(2, 30), (5, 20), (8, 10)])
def test_the_thesis_distances_never_lose_value(used_distance, direction_distance):
    # twelve boxes of four sizes, several of each, as in chapter 4
    sizes = np.random.default_rng(7).integers(3, 8, (4, 3)).tolist() * 3
    given_problem = problem(sizes, 11)
    packing = search(
        given_problem, used_distance=used_distance, direction_distance=direction_distance, effort=0.01
    )
    instance = prepare(given_problem)
    assert value(given_problem, packing) >= value_of(instance, start(instance))
    assert packing.bound >= value(given_problem, packing)


def test_a_search_that_does_not_grow_ends_where_nothing_near_is_better_and_claims_no_proof():
    given_problem = problem(np.random.default_rng(3).integers(2, 6, (8, 3)).tolist(), 7)
    packing = search(given_problem, used_distance=1, direction_distance=0, growth=1.0, effort=10.0)
    assert packing.stop_reason == "finished"
    assert packing.bound >= value(given_problem, packing)


def test_a_search_stopped_at_once_gives_its_start():
    given_problem = problem(np.random.default_rng(3).integers(2, 6, (30, 3)).tolist(), 9)
    assert search(given_problem, Stop.after(0.0)).stop_reason == "time limit"


@pytest.mark.parametrize("wrong", [{"used_distance": 0}, {"growth": 0.5}, {"steps": 0}, {"effort": -1.0}])
def test_a_parameter_out_of_bounds_is_refused_by_name(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        IpLocalSearchParams(**wrong)
