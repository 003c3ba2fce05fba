"""The packer `column-generation`: covers pack everything, bounds are never above the fewest builds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.boxes import boxes_problem
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Stop, silent
from amprep.plugins.packers.column_generation import pack_column_generation, price_builds, useful
from amprep.plugins.packers.column_generation.columns import (
    Column,
    arrangement_from,
    single_columns,
)
from amprep.plugins.packers.column_generation.master import fractional_cover, integer_cover
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.integer_program import pack_ip
from amprep.plugins.packers.params import ColumnGenerationParams, IpParams


def problem(sizes, room=4, **rules):
    return boxes_problem(sizes, room, **rules)


def run(given_problem, stop=None, **params):
    rng, chosen = np.random.default_rng(1), ColumnGenerationParams(**params)
    packing = pack_column_generation(
        given_problem, params=chosen, rng=rng, stop=stop or Stop(), progress=silent
    )
    assert check_packing(given_problem, packing) == []
    return packing


def column(*types):
    """A column of given item types; positions do not matter to a cover."""
    return Column(np.array(types), np.zeros(len(types), np.int64), np.zeros((len(types), 3)))


side = st.integers(1, 4)


@examples(40)
@given(st.lists(st.tuples(side, side, side), min_size=1, max_size=8))
def test_bound_and_builds_enclose_the_fewest_builds_that_the_program_proves(sizes):
    given_problem = problem(sizes)
    rng = np.random.default_rng(1)
    exact = pack_ip(given_problem, params=IpParams(effort=10.0), rng=rng, stop=Stop(), progress=silent)
    assert exact.status == "optimal"
    packing = run(given_problem, effort=1.0)
    assert packing.bound <= len(exact.builds) <= len(packing.builds)


def test_pricing_proves_what_volume_does_not():
    # cubes of 3 in a room of 5 fit one by one, though nearly half the room stays free: 2.16 builds by volume
    packing = run(problem([(3, 3, 3)] * 10, room=5))
    assert (len(packing.builds), packing.bound, packing.status) == (10, 10.0, "optimal")


def test_a_fractional_cover_of_a_triangle_prices_each_item_at_a_half():
    # builds hold any two of three items: half of each build is enough, so each item costs a half
    cover = fractional_cover([column(0, 1), column(1, 2), column(0, 2)], np.ones(3, int), IpParams())
    assert np.allclose(cover.fraction, 0.5)
    assert np.allclose(cover.price, 0.5)


def test_an_integer_cover_counts_items_of_a_type():
    # five items of one type in builds of two: three builds, however many builds with one item there are
    chosen = present(integer_cover([column(0), column(0, 0)], np.array([5]), IpParams(), Stop()))
    assert len(chosen) == 3
    assert sum(len(each.type_of) for each in chosen) >= 5


def test_an_item_that_is_covered_twice_is_placed_once_and_superfluous_builds_are_dropped():
    instance = prepare(problem([(1, 1, 1), (2, 1, 1), (3, 1, 1)]))
    columns = [column(0, 1), column(1), column(1, 2)]
    assert [each.type_of.tolist() for each in useful(instance, columns)] == [[0, 1], [1, 2]]
    assert arrangement_from(instance, columns).build.tolist() == [0, 0, 1]


def test_no_build_has_a_value_above_its_cost_when_each_item_has_the_price_of_one_build():
    # items that exclude each other, each at price 1: no build has a value above 1, and pricing proves it
    instance = prepare(problem([(3, 3, 3), (3, 3, 4), (4, 3, 3)]))
    cover = fractional_cover(single_columns(instance), instance.demand, ColumnGenerationParams())
    assert np.allclose(cover.price, 1.0)
    rng = np.random.default_rng(1)
    priced = price_builds(instance, cover.price, ColumnGenerationParams(effort=1.0), rng, Stop())
    assert priced.columns == []
    assert 1.0 <= priced.bound <= 1.0 + 1e-5


def test_turned_items_and_zones_are_packed():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turns = Orientations(matrices=np.array([np.eye(3), turn]))
    items = tuple(Item(i, 0, Boxes(np.zeros((1, 3)), np.array([[4.0, 2, 3]])), 1.0, turns) for i in range(5))
    space = BuildVolume(np.full(3, 4.0), "box", np.array([[0.0, 0, 3]]), np.array([[4.0, 2, 4]]))
    # two side by side are 3 high and fill the room below the zone
    packing = run(PackingProblem(items, space, "builds"))
    assert (len(packing.builds), packing.status) == (3, "optimal")


def test_an_item_that_fits_no_build_is_named_and_the_rest_packed():
    packing = run(problem([(5, 1, 1), (4, 4, 3), (4, 4, 2), (4, 4, 2), (4, 4, 1)]))
    assert (packing.status, len(packing.builds)) == ("infeasible", 2)
    assert [(u.item, u.reason) for u in packing.unplaced] == [(0, "too large")]


def test_the_same_problem_gives_the_same_packing():
    given_problem = problem(np.random.default_rng(5).integers(2, 6, (16, 3)).tolist(), room=9)
    one, other = run(given_problem, rounds=5), run(given_problem, rounds=5)
    assert [[p.matrix.tolist() for p in b] for b in one.builds] == [
        [p.matrix.tolist() for p in b] for b in other.builds
    ]


@pytest.mark.parametrize("wrong", [{"rounds": -1}, {"restarts": -1}, {"roundings": -1}, {"threads": 0}])
def test_a_parameter_out_of_bounds_is_refused_by_name(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        ColumnGenerationParams(**wrong)
