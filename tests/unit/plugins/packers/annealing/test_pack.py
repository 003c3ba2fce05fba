"""The packer `annealing`: its packings keep the promise, and are no worse than their first layout."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.annealing import ENGINES, l_shape, shapes_problem
from tests.shared.boxes import boxes_problem
from tests.shared.examples import examples

from amprep.checks.packing.volumes_placed import PlacedVolume, check_packing
from amprep.errors import AmprepError
from amprep.model import BuildVolume, Orientations, Placement, Stop, silent
from amprep.model.rotations import axis_rotations, quarter_turns
from amprep.plugins.packers.annealing.pack import pack_annealing
from amprep.plugins.packers.annealing.params import AnnealingParams

ANY = Orientations("list", axis_rotations())


def packed(problem, stop=None, progress=silent, **params):
    rng = np.random.default_rng(1)
    # most tests are about the moves from a first layout of boxes
    chosen = AnnealingParams(**{"start": "extreme-points", **params})
    return pack_annealing(problem, params=chosen, rng=rng, stop=stop or Stop(), progress=progress)


def top_of(problem, packing):
    placed = (PlacedVolume(problem, placement, fixed=False) for placement in packing.builds[0])
    return max(float(volume.points[:, 2].max()) for volume in placed)


def loss(problem, packing):
    """Return what is smaller for better packings: the volume left out (the value for `fill`), then the objective."""
    left = sum(problem.items[entry.item].value for entry in packing.unplaced)
    if problem.objective == "height":
        return round(left, 6), top_of(problem, packing)
    return round(left, 6), len(packing.builds)


def test_two_l_shapes_that_interlock_are_packed_into_the_box_that_they_fill():
    # as boxes they need a height of 8; with half a turn about y, two L fill 6 x 4 x 4
    turns = Orientations("list", np.array([np.eye(3), np.diag([-1.0, 1.0, -1.0])]))
    problem = shapes_problem(
        "pieces", [(4, 4, 4)] * 2, (6.05, 4.05, 20.0), orientations=turns, objective="height"
    )
    packing = packed(problem, moves=4000)
    assert check_packing(problem, packing) == []
    assert top_of(problem, packing) <= 4.0 + 1e-3
    assert top_of(problem, packed(problem, moves=0)) == pytest.approx(8.0)


def test_boxes_in_one_layer_reach_the_bound_and_are_reported_as_optimal():
    problem = boxes_problem([(5, 5, 3)] * 4, (10.01, 10.01, 20), objective="height")
    packing = packed(problem)
    assert packing.status == "optimal"
    assert packing.bound == pytest.approx(3.0, abs=1e-6)


def test_a_build_that_boxes_cannot_fill_is_filled_with_meshes():
    """Four L in pairs fill the build exactly; their boxes fit it twice only."""
    turns = Orientations("list", np.array([np.eye(3), np.diag([-1.0, 1.0, -1.0])]))
    problem = shapes_problem("trees", [(4, 4, 4)] * 4, (6.1, 8.1, 4.1), orientations=turns, objective="fill")
    boxes = packed(problem, moves=0)
    packing = packed(problem, moves=4000)
    assert check_packing(problem, packing) == []
    assert len(boxes.builds[0]) < len(packing.builds[0]) == 4


def test_builds_are_saved_where_meshes_fit_into_each_other():
    turns = Orientations("list", np.array([np.eye(3), np.diag([-1.0, 1.0, -1.0])]))
    problem = shapes_problem("pieces", [(4, 4, 4)] * 4, (6.1, 4.1, 4.1), orientations=turns)
    assert len(packed(problem, moves=0).builds) == 4
    packing = packed(problem, moves=3000)
    assert check_packing(problem, packing) == []
    assert len(packing.builds) == 2


def test_the_first_layout_is_one_of_the_shapes_themselves_unless_parts_must_not_be_stacked():
    turns = Orientations("list", np.array([np.eye(3), np.diag([-1.0, 1.0, -1.0])]))
    problem = shapes_problem("pieces", [(4, 4, 4)] * 4, (6.1, 4.1, 4.1), orientations=turns)
    assert AnnealingParams().start == "separation"
    assert len(packed(problem, start="separation", moves=0).builds) == 2
    flat = packed(replace(problem, stacking=False), start="separation", moves=0)
    assert check_packing(replace(problem, stacking=False), flat) == []
    assert len(flat.builds) == 4


@pytest.mark.parametrize("objective", ["fill", "builds", "height"])
@pytest.mark.parametrize("start", ["extreme-points", "auto", "sweep", "separation", "outside"])
def test_every_start_and_objective_gives_a_packing_that_is_no_worse_than_it(start, objective):
    rng = np.random.default_rng(5)
    problem = boxes_problem(rng.uniform(2, 6, (12, 3)).round(1).tolist(), (9, 9, 12), objective=objective)
    first, packing = (packed(problem, start=start, moves=moves) for moves in (0, 100))
    assert check_packing(problem, packing) == []
    assert packing.builds
    if first.builds:
        assert loss(problem, packing) <= loss(problem, first)


@pytest.mark.parametrize("freedom", ["list", "about-z", "free"])
@pytest.mark.parametrize("word", ENGINES)
@pytest.mark.parametrize("shape", ["box", "cylinder"])
def test_volumes_of_every_kind_keep_clearance_beside_zones_and_fixed_parts(shape, word, freedom):
    space = BuildVolume(np.full(3, 26.0), shape, [[10.0, 10, 0]], [[13.0, 13, 26]])
    turns = Orientations(freedom, quarter_turns())
    problem = shapes_problem(
        word, [(6, 4, 6), (5, 5, 8), (8, 3, 4), (4, 4, 4)], space=space, orientations=turns,
        clearance=0.5, lift=1.0, objective="height",
    )  # fmt: skip
    fixed = Placement(3, np.eye(3), np.array([14.0, 14.0, 1.0]))
    problem = replace(problem, fixed=(fixed,))
    packing = packed(problem, moves=150)
    assert check_packing(problem, packing) == []
    assert packing.unplaced == ()


@examples(15)
@given(
    st.lists(st.tuples(*[st.integers(1, 6)] * 3), min_size=1, max_size=6),
    st.sampled_from(["fill", "builds", "height"]),
    st.sampled_from([0.0, 0.5]),
    st.booleans(),
)
def test_a_packing_of_boxes_keeps_its_promise(sizes, objective, clearance, stacking):
    problem = boxes_problem(
        sizes, (8, 8, 8), orientations=ANY, objective=objective, clearance=clearance, stacking=stacking
    )
    assert check_packing(problem, packed(problem, moves=100)) == []


@pytest.mark.parametrize("word", ENGINES)
def test_a_zone_that_goes_on_beside_the_build_volume_is_not_entered_from_there(word):
    space = BuildVolume(np.full(3, 20.0), "box", [[8.0, -50, -50]], [[300.0, 300, 300]])
    problem = shapes_problem(word, [(4, 5, 4)] * 8, space=space, objective="fill")
    packing = packed(problem, moves=300, drops=0.1, start="outside")
    assert check_packing(problem, packing) == []
    assert packing.builds


def test_a_stop_returns_the_best_layout_so_far_within_milliseconds():
    problem = boxes_problem([(3, 3, 3)] * 30, (9.5, 9.5, 60), objective="height")
    told: list[Any] = []

    class Later(Stop):
        def __call__(self):
            return len(told) > 3

    packing = packed(problem, stop=Later(), progress=lambda f, m: told.append(f), moves=1_000_000)
    assert check_packing(problem, packing) == []
    assert len(told) == 4
    assert told[-1] < 0.1


def test_progress_tells_what_is_placed_and_how_high():
    problem = boxes_problem([(3, 3, 3)] * 3, (4, 4, 60), objective="height")
    told: list[Any] = []
    packed(problem, progress=lambda f, m: told.append((f, m)), moves=500)
    assert all(0.0 <= fraction <= 1.0 for fraction, _ in told)
    assert told[-1][1].startswith("3 of 3 items, ")


def test_an_item_that_fits_no_build_is_reported_as_too_large():
    problem = replace(boxes_problem([(3, 3, 3)]), objective="height")
    large = replace(problem.items[0], part=1, volume=l_shape("trees", np.array([30.0, 3, 3])))
    packing = packed(replace(problem, items=(*problem.items, large)))
    assert [(entry.item, entry.reason) for entry in packing.unplaced] == [(1, "too large")]


def test_an_engine_that_cannot_handle_the_volumes_is_refused_by_name():
    problem = shapes_problem("trees", [(4, 4, 4)])
    with pytest.raises(AmprepError, match=r"collision = 'boxes' needs boxes .* choose 'any'"):
        packed(problem, collision="boxes")


def test_a_negative_value_is_refused():
    with pytest.raises(AmprepError, match="value must be between 0 and"):
        packed(boxes_problem([(3, 3, 3)], values=[-1.0]), start="outside")
