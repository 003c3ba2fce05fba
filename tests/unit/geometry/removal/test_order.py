"""Removal orders: each step is free of collisions for an independent judge, and what is locked is named."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.removal import (
    DRAWER,
    bayonet,
    blocking_of,
    box,
    cup,
    drawer_case,
    hook_in_ring,
    ring,
)

from amprep.checks.packing.removal import check_removal_order
from amprep.geometry.removal.order import find_removal_order, with_blockers

UP = (((0.0, 0.0, 1.0), np.inf),)


def judged(solids):
    """Return the order, after the independent judge has accepted it."""
    blocking = blocking_of(solids)
    order = with_blockers(blocking, find_removal_order(blocking))
    assert check_removal_order(solids, [str(body) for body in range(len(solids))], order, 0.7) == []
    return order


def test_stacked_cups_leave_upwards_from_the_top():
    order = judged([cup(0), cup(6), cup(3)])
    assert [step.bodies for step in order.steps] == [(1,), (2,), (0,)]
    assert all(step.path == UP for step in order.steps)
    assert [step.after for step in order.steps] == [(), (1,), (1, 2)]


def test_a_drawer_leaves_sideways_through_the_open_side():
    order = judged([drawer_case(), DRAWER])
    assert order.steps[0].bodies == (1,)
    assert order.steps[0].path == (((1.0, 0.0, 0.0), np.inf),)


def test_a_bolt_leaves_a_slot_by_two_motions():
    order = judged(bayonet())
    assert order.locked == ()
    assert len(order.steps[0].path) > 1


def test_a_hook_in_a_ring_is_locked():
    assert judged(hook_in_ring()).locked == ((0, 1),)


def test_links_of_a_chain_are_one_locked_group_beside_parts_that_leave():
    links = [ring((0, 14 * k, 0), "xz"[k % 2]) for k in range(3)]
    order = judged([*links, box((-20, -20, 20), (20, 40, 25)), box((30, 0, 0), (35, 5, 5))])
    assert [set(group) for group in order.locked] == [{0, 1, 2}]
    assert {step.bodies for step in order.steps} == {(3,), (4,)}


def test_groups_that_are_locked_in_themselves_are_taken_apart_from_each_other():
    case = box((-30, -30, -30), (30, 30, 30)) - box((-26, -26, -26), (40, 26, 26))
    linked = [case + ring((-40, 0, 0), "z"), ring((-50, 0, 0), "y")]
    order = judged([*hook_in_ring(), *linked])
    assert sorted(map(sorted, order.locked)) == [[0, 1], [2, 3]]
    assert len(order.steps[0].bodies) == 2


def test_a_body_that_another_encloses_is_locked_into_it():
    hollow = box((0, 0, 0), (20, 20, 20)) - box((2, 2, 2), (18, 18, 18))
    assert judged([hollow, box((5, 5, 5), (9, 9, 9))]).locked == ((0, 1),)


def test_after_a_stop_the_bodies_that_were_not_judged_are_unknown():
    order = find_removal_order(blocking_of([cup(0), cup(3)]), stop=lambda: True)
    assert order.unknown == (0, 1)


@pytest.mark.parametrize("gap", [0.0, 0.4])
def test_boxes_in_a_grid_leave_upwards(gap):
    solids = [box(np.array(cell) * 10.0, np.array(cell) * 10.0 + 10.0 - gap) for cell in np.ndindex(3, 3, 3)]
    order = judged(solids)
    assert order.locked == ()
    assert all(step.path == UP for step in order.steps)


@examples(15)
@given(st.integers(0, 10**6))
def test_orders_of_random_brackets_are_free_of_collisions(seed):
    rng = np.random.default_rng(seed)
    solids: list[Any] = []
    while len(solids) < 6:
        low = rng.uniform(0, 30, 3)
        size = rng.uniform(8, 22, 3)
        bracket = box(low, low + size) - box(
            low + rng.uniform(-4, 4, 3), low + size * rng.uniform(0.6, 1.1, 3)
        )
        if bracket.volume() > 50 and all((bracket ^ other).volume() == 0 for other in solids):
            solids.append(max(bracket.decompose(), key=lambda piece: piece.volume()))
    judged(solids)
