"""The judge of removal orders refuses wrong ones."""

import numpy as np
from tests.shared.removal import DRAWER, cup, drawer_case

from amprep.checks.packing.removal import check_removal_order
from amprep.geometry.removal.order import RemovalOrder, RemovalStep

UP = (((0.0, 0.0, 1.0), np.inf),)


def judge(solids, order):
    return check_removal_order(solids, [str(body) for body in range(len(solids))], order, 0.5)


def test_lower_cups_do_not_leave_before_upper_ones():
    cups = [cup(0), cup(3)]
    right = RemovalOrder((RemovalStep((1,), UP), RemovalStep((0,), UP)))
    wrong = RemovalOrder(right.steps[::-1])
    assert judge(cups, right) == []
    assert [found.subject for found in judge(cups, wrong)] == ["0"]


def test_a_drawer_does_not_leave_upwards():
    order = RemovalOrder((RemovalStep((1,), UP), RemovalStep((0,), UP)))
    assert [found.subject for found in judge([drawer_case(), DRAWER], order)] == ["1"]


def test_a_path_that_ends_too_early_to_turn_is_refused():
    out = (1.0, 0.0, 0.0)
    order = RemovalOrder((RemovalStep((1,), ((out, 5.0), *UP)), RemovalStep((0,), UP)))
    assert judge([drawer_case(), DRAWER], order)
    order = RemovalOrder((RemovalStep((1,), ((out, 28.0), *UP)), RemovalStep((0,), UP)))
    assert judge([drawer_case(), DRAWER], order) == []


def test_a_body_that_never_leaves_is_named_unless_it_is_locked():
    assert [found.subject for found in judge([DRAWER], RemovalOrder())] == ["0"]
    assert judge([DRAWER], RemovalOrder(locked=((0,),))) == []
