"""Supports of different parts are apart, and keep their distance from other parts, or are named."""

from dataclasses import replace

import pytest
from tests.shared.supported import box, build_of, table

from amprep.checks.neighbours.apart import APART, NEIGHBOURS, check_apart
from amprep.model import Stop


def judged(supports, clearance=0.0, stop=None, **rules):
    """Judge supports below two plates with 4 mm between them in plan."""
    build = build_of([table(10), table(10, corner=(24.0, 0.0))], supports, **rules)
    return check_apart(replace(build, settings=replace(build.settings, clearance=clearance)), stop or Stop())


def found(supports, *clearance, **rules):
    return [(each.promise, each.subject) for each in judged(supports, *clearance, **rules)]


def test_supports_of_two_parts_that_share_a_volume_are_named_and_those_that_touch_are_not():
    left, right = box((6, 6, 10.1), (15, 5, 0)), box((6, 6, 10.1), (20.5, 5, 0))
    assert found([left, right]) == [(APART, "support-0")]
    assert found([left, right.translate([0.5, 0, 0])]) == []


def test_the_volume_that_two_supports_share_is_measured():
    supports = [box((6, 6, 10), (15, 5, 0)), box((6, 6, 10), (20.5, 5, 0))]
    (violation,) = judged(supports)
    assert "enters support-1: 30 mm3" in violation.message  # 0.5 x 6 x 10


@pytest.mark.parametrize(("side", "expected"), [(21.9, []), (22.3, [(NEIGHBOURS, "support-0")])])
def test_a_support_keeps_the_clearance_less_the_margin_from_a_part_that_it_does_not_hold(side, expected):
    """A clearance of 2 mm, no margin: a support beside a plate at x = 24 may reach to x = 22."""
    supports = [box((side - 15, 6, 13.0), (15, 5, 0))]
    assert found(supports, 2.0, territory="own") == expected


def test_nothing_is_judged_after_an_interruption():
    stop = Stop()
    stop.cancelled.set()
    supports = [box((6, 6, 10.1), (15, 5, 0)), box((6, 6, 10.1), (20.5, 5, 0))]
    assert judged(supports, stop=stop) == []
