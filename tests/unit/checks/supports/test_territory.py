"""Territory: supports in the shadow of their part with its margin keep the promise; others are named."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.supported import box, build_of, table

from amprep.checks.supports.territory import TOLERANCE, check_territory
from amprep.model import Overrides, Stop

OWN = {"territory": "own", "territory_margin_mm": 1.0}


def judged(parts, bodies, **rules):
    return check_territory(build_of(parts, bodies, **(OWN | rules)), Stop())


@given(st.floats(-3, 3), st.floats(0, 2))
@examples(25)
def test_a_support_may_leave_the_shadow_by_the_margin(beyond, margin):
    found = judged([table(10)], [box((2, 2, 10.1), (18 + beyond, 5, 0))], territory_margin_mm=margin)
    if beyond <= margin:
        assert found == []
    elif beyond > margin + 2 * TOLERANCE:
        assert "margin" in found[0].message


def test_corners_of_the_territory_are_round():
    corner = box((1, 1, 10.1), (20, 20, 0))
    assert len(judged([table(10)], [corner])) == 1
    assert judged([table(10)], [corner.translate((-0.3, -0.3, 0))]) == []


def test_holes_of_the_shadow_are_no_territory_where_they_are_wide():
    ring = Manifold.cylinder(3, 20, 20, 64) - Manifold.cylinder(3, 15, 15, 64)
    centre = box((2, 2, 10), (-1, -1, 0))
    assert len(judged([ring.translate((0, 0, 10))], [centre])) == 1
    assert judged([ring.translate((0, 0, 10))], [centre.translate((16.5, 0, 0))]) == []


def test_a_support_in_the_shadow_of_a_neighbour_is_named():
    parts = [table(10), table(10, corner=(20.5, 0))]
    (violation,) = judged(parts, [box((1, 1, 10), (19.9, 5, 0)), box((1, 1, 10), (25, 5, 0))])
    assert "enters the shadow of part-1" in violation.message
    assert "part-0" in violation.message
    assert violation.subject == "support-0"


def test_below_the_own_shadow_a_support_may_be_below_another_part_too():
    assert judged([table(10), table(30)], [box((2, 2, 10), (5, 5, 0))]) == []
    (violation,) = judged([table(10), table(30, side=40.0)], [box((1.2, 2, 10), (19.5, 5, 0))])
    assert "enters" in violation.message


@pytest.mark.parametrize("shared", [True, False])
def test_a_shared_support_may_be_in_the_territory_of_either_part(shared):
    build = build_of([table(10), table(10, corner=(22, 0))], [box((4, 2, 10), (19, 5, 0))], **OWN)
    body = replace(build.supports[0], parts=(0, 1) if shared else (0,))
    assert bool(check_territory(replace(build, supports=(body,)), Stop())) != shared


def test_with_shared_territory_nothing_is_judged():
    assert judged([table(10)], [box((2, 2, 10), (50, 50, 0))], territory="shared") == []


def test_a_margin_of_the_part_itself_takes_the_place_of_that_of_the_rules():
    build = build_of([table(10)], [box((2, 2, 10.1), (21, 5, 0))], **OWN)
    assert len(check_territory(build, Stop())) == 1
    (placed,) = build.parts
    wide = replace(placed, part=replace(placed.part, overrides=Overrides(territory_margin_mm=3.0)))
    assert check_territory(replace(build, parts=(wide,)), Stop()) == []
