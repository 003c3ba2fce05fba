"""Parts are moved vertically so that layers become more equal, and keep all rules."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.removal import cup
from tests.shared.solids import volume_of_solid

from amprep.checks.packing.volumes_placed import check_packing
from amprep.measures.objective import objective_reached
from amprep.model import Boxes, BuildVolume, Item, Packing, PackingProblem, Part, Placement, Stop
from amprep.repacking.even_layers import even_layers
from amprep.testing.problems import box_mesh


def boxes_at(sizes, corners, **rules):
    """Boxes with their lowest corners, and the problem that they solve."""
    items = [
        Item(k, 0, Boxes(np.zeros((1, 3)), np.array([size], float)), 1.0) for k, size in enumerate(sizes)
    ]
    parts = [Part(f"p{k}", box_mesh([0, 0, 0], size), 1.0) for k, size in enumerate(sizes)]
    build = tuple(Placement(k, np.eye(3), np.array(corner, float)) for k, corner in enumerate(corners))
    rules = {"clearance": 1.0, **rules}
    problem = PackingProblem(tuple(items), BuildVolume(np.full(3, 60.0)), "height", **rules)
    return problem, Packing((build,)), parts


def test_boxes_beside_a_tower_are_spread_over_its_height():
    sizes = [[10, 10, 40]] + [[10, 10, 10]] * 4
    corners = [[1, 1, 1], [12, 1, 1], [23, 1, 1], [34, 1, 1], [45, 1, 1]]
    problem, packing, parts = boxes_at(sizes, corners, lift=1.0)
    evened, (gain,) = even_layers(problem, packing, parts, Stop())
    assert check_packing(problem, evened) == []
    assert objective_reached(problem, evened) == objective_reached(problem, packing)
    heights = sorted(placement.translation[2] for placement in evened.builds[0][1:])
    np.testing.assert_allclose(heights, [1, 11, 21, 31], atol=0.2)
    assert gain.moved == 3
    assert gain.after < 0.1 < gain.before


def test_fixed_parts_stay():
    sizes, corners = [[10, 10, 40], [10, 10, 10], [10, 10, 10]], [[1, 1, 0], [12, 1, 0], [23, 1, 0]]
    problem, packing, parts = boxes_at(sizes, corners)
    problem = PackingProblem(
        problem.items, problem.space, "builds", fixed=packing.builds[0][1:], clearance=1.0
    )
    evened, gains = even_layers(problem, packing, parts, Stop())
    assert gains == ()
    assert [each.translation.tolist() for each in evened.builds[0]] == corners


def test_parts_do_not_pass_through_each_other():
    sizes, corners = [[30, 30, 2], [10, 10, 10], [5, 5, 40]], [[0, 0, 20], [5, 5, 1], [40, 40, 0]]
    problem, packing, parts = boxes_at(sizes, [[each + 1 for each in corner] for corner in corners])
    evened, _ = even_layers(problem, packing, parts, Stop())
    assert check_packing(problem, evened) == []
    assert evened.builds[0][1].translation[2] + 10 < evened.builds[0][0].translation[2]


def test_true_shapes_move_within_each_other():
    solid = volume_of_solid(cup(0))
    items = tuple(Item(0, k, solid, 1.0) for k in range(3))
    parts = [Part("cup", solid.mesh, 1.0)]
    problem = PackingProblem(items, BuildVolume(np.full(3, 80.0)), "height", clearance=0.4)
    stack = tuple(
        Placement(k, np.eye(3), np.array([20.0, 20.0, height])) for k, height in enumerate((0, 3, 40))
    )
    evened, (gain,) = even_layers(problem, Packing((stack,)), parts, Stop())
    assert check_packing(problem, evened) == []
    assert objective_reached(problem, evened) <= 60.0 + 1e-6
    assert gain.after < gain.before
    heights = [placement.translation[2] for placement in evened.builds[0]]
    assert heights == sorted(heights), "cups keep their order"


@examples(12)
@given(st.integers(0, 10**6))
def test_random_packings_of_boxes_keep_the_rules_and_become_no_less_even(seed):
    rng = np.random.default_rng(seed)
    sizes: list[Any] = []
    corners: list[Any] = []
    for column in np.ndindex(3, 3):
        z = 1.0
        while len(sizes) < 30 and z < 40:
            size = rng.uniform(4, 14, 3)
            sizes.append(size)
            corners.append([1 + 16 * column[0], 1 + 16 * column[1], z])
            z += size[2] + rng.uniform(1, 8)
    problem, packing, parts = boxes_at(sizes, corners)
    evened, gains = even_layers(problem, packing, parts, Stop())
    assert check_packing(problem, evened) == []
    assert all(gain.after < gain.before for gain in gains)
    assert objective_reached(problem, evened) <= objective_reached(problem, packing) + 1e-9


def test_a_stop_leaves_the_packing_as_it_is():
    problem, packing, parts = boxes_at(
        [[10, 10, 40], [10, 10, 10], [9, 9, 9]], [[1, 1, 1], [12, 1, 1], [23, 1, 1]]
    )
    evened, gains = even_layers(problem, packing, parts, Stop.after(-1.0))
    assert gains == ()
    assert evened.builds == packing.builds


@pytest.mark.parametrize("shift", [0.0, 5.0])
def test_an_empty_packing_stays_empty(shift):
    problem, _, parts = boxes_at([[10, 10, 10]], [[1, 1, 1 + shift]])
    assert even_layers(problem, Packing(()), parts, Stop())[0].builds == ()
