"""Bounds on packings of true shapes: net shadows, volume, the highest shape; no packing is better than its bound."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold
from tests.shared.examples import examples
from tests.shared.solids import volume_of_solid

from amprep.measures.objective import objective_reached
from amprep.measures.parts_bound import parts_bound, shadow_area, shape_extents
from amprep.model import (
    Boxes,
    BuildVolume,
    Item,
    Orientations,
    PackingProblem,
    Placement,
    Stop,
    silent,
)
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.params import ExtremePointsParams


def plate(side, hole=0.0, height=10.0):
    """A square plate with a square hole through it."""
    outline = CrossSection.square((side, side), True)
    if hole:
        outline -= CrossSection.square((hole, hole), True)
    return volume_of_solid(Manifold.extrude(outline, height))


def problem(volumes, room, objective="builds", orientations=None, **rules):
    allowed = orientations or Orientations()
    items = tuple(Item(number, 0, volume, 1.0, allowed) for number, volume in enumerate(volumes))
    return PackingProblem(items, BuildVolume(np.array(room, float)), objective, **rules)


def test_the_shadow_of_a_plate_has_its_net_area_and_grows_by_round_corners():
    assert shadow_area(plate(40, 20), np.eye(3), 0.0) == pytest.approx(40**2 - 20**2)
    grown = shadow_area(plate(40), np.eye(3), 5.0)
    exact = 40**2 + 4 * 40 * 5 + np.pi * 25
    assert exact * 0.998 < grown <= exact
    assert shadow_area(plate(40, 8), np.eye(3), 5.0) == pytest.approx(grown)


@pytest.mark.parametrize(("hole", "builds"), [(0, 3), (48, 1)])
def test_holes_leave_room_on_the_plate_for_other_parts(hole, builds):
    given = problem([plate(60, hole)] * 6, (100, 100, 100), stacking=False)
    assert parts_bound(given) == builds


def test_the_clearance_takes_its_part_of_the_plate():
    four = [plate(50)] * 4
    assert parts_bound(problem(four, (100, 100, 50), stacking=False)) == 1
    assert parts_bound(problem(four, (110, 110, 50), stacking=False, clearance=10.0)) == 2


def test_with_stacking_parts_share_the_volume():
    assert parts_bound(problem([plate(50)] * 12, (50, 50, 50))) == 3
    assert parts_bound(problem([plate(50)] * 12, (50, 50, 120))) == 1


def test_an_upright_plate_takes_less_area_where_it_may_be_turned():
    turns = Orientations(matrices=axis_rotations())
    six = [plate(90)] * 6
    assert parts_bound(problem(six, (100, 100, 100), stacking=False)) == 5
    assert parts_bound(problem(six, (100, 100, 100), stacking=False, orientations=turns)) == 1


def test_the_height_is_at_least_that_of_the_highest_part_and_that_of_all_volume():
    mixed = [plate(50), plate(10, height=30.0)]
    assert parts_bound(problem(mixed, (50, 50, 200), "height", lift=2.0)) == pytest.approx(32.0)
    assert parts_bound(problem([plate(50)] * 8, (50, 50, 200), "height")) == pytest.approx(80.0, abs=0.1)
    free = Orientations("free")
    assert parts_bound(problem([plate(20)], (50, 50, 200), "height", free)) < 10.0


@pytest.mark.parametrize(
    ("width", "clearance", "height"),
    [(30.0, 0.0, 10.0), (29.9, 0.0, 30.0), (32.0, 1.0, 10.0), (31.9, 1.0, 30.0), (5.0, 0.0, 10.0)],
)
def test_a_part_that_is_too_long_to_lie_counts_as_high_as_it_stands(width, clearance, height):
    """Where it is too wide in every orientation, all count."""
    turns = Orientations("list", axis_rotations())
    given = problem([plate(10, height=30.0)], (width, width, 100), "height", turns, clearance=clearance)
    assert shape_extents(given.items[0], given).height == pytest.approx(height)


def test_the_greatest_value_is_that_of_the_parts_that_share_the_build():
    bound = parts_bound(problem([plate(50)] * 8, (50, 50, 50), "fill"))
    assert bound == pytest.approx(5.0, abs=0.01)


def test_fixed_items_take_no_room_but_count():
    given = problem([plate(50)] * 3, (50, 50, 10))
    fixed = PackingProblem(given.items, given.space, fixed=(Placement(0, np.eye(3), np.zeros(3)),))
    assert parts_bound(fixed) == 2
    alone = PackingProblem(given.items[:1], given.space, "height", (Placement(0, np.eye(3), np.zeros(3)),))
    assert parts_bound(alone) == pytest.approx(10.0)


def test_items_left_out_do_not_count():
    given = problem([plate(50)] * 3, (50, 50, 10))
    assert parts_bound(given, without=(0, 1)) == 1


@examples(40)
@given(data=st.data())
def test_no_packing_is_better_than_the_bound(data):
    sizes = data.draw(st.lists(st.tuples(*[st.integers(2, 12)] * 3), min_size=1, max_size=9))
    volumes = [Boxes(np.zeros((1, 3)), np.array([size], float)) for size in sizes]
    round_plate = data.draw(st.booleans())
    space = BuildVolume(np.array([20.0, 20.0, 15.0]), "cylinder" if round_plate else "box")
    items = tuple(
        Item(number, 0, volume, float(number + 1), Orientations(matrices=axis_rotations()))
        for number, volume in enumerate(volumes)
    )
    given_problem = PackingProblem(
        items,
        space,
        data.draw(st.sampled_from(["builds", "fill", "height"])),
        clearance=data.draw(st.sampled_from([0.0, 0.5, 2.0])),
        lift=data.draw(st.sampled_from([0.0, 1.0])),
        stacking=data.draw(st.booleans()),
    )
    params = ExtremePointsParams(orderings=3)
    packing = pack_extreme_points(
        given_problem, params=params, rng=np.random.default_rng(0), stop=Stop(), progress=silent
    )
    left = [each.item for each in packing.unplaced]
    bound, reached = parts_bound(given_problem, left), objective_reached(given_problem, packing)
    if given_problem.objective == "fill":
        assert reached <= bound + 1e-9
    else:
        assert reached >= bound - 1e-9
