"""Least section: thin supports, needles and fins are found, right ones are not."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.supported import box, build_of, table

from amprep.checks.supports.least_section import (
    LEAST_CONTACT,
    LEAST_WALL,
    TOLERANCE,
    check_least_section,
)
from amprep.model import Stop
from amprep.model.supports.sizes import SupportSizes

RULES = {"least_wall_mm": 0.3, "least_contact_mm2": 0.09}


def judged(body, part=None, sizes=None, **rules):
    part = table(10) if part is None else part
    return check_least_section(build_of([part], [body], sizes, **(RULES | rules)), Stop())


def promises(body, **settings):
    return {violation.promise for violation in judged(body, **settings)[0]}


def post(width, depth=None, height=10.1):
    return box((width, depth or width, height), (5, 5, 0))


@given(st.floats(0.05, 0.8), st.floats(0, 90))
@examples(20)
def test_a_wall_breaks_the_promise_exactly_if_it_is_thinner_than_the_least(width, turn):
    wall = post(width, 8.0).rotate((0, 0, turn))
    if width < 0.3 - 1.5 * TOLERANCE:
        assert LEAST_WALL in promises(wall)
    elif width >= 0.3:
        assert promises(wall) == set()


def test_a_needle_beside_thick_supports_is_found():
    needle = post(3) + box((0.05, 0.05, 8), (8.1, 6, 0))
    assert promises(needle) == {LEAST_WALL, LEAST_CONTACT}


@pytest.mark.parametrize("shape", ["plus", "x", "tube", "round"])
def test_thick_sections_with_sharp_corners_keep_the_promise(shape):
    bars = box((4, 0.4, 10), (-2, -0.2, 0)), box((0.4, 4, 10), (-0.2, -2, 0))
    shapes = {
        "plus": bars[0] + bars[1],
        "x": bars[0].rotate((0, 0, 25)) + bars[0].rotate((0, 0, -25)),
        "tube": Manifold.cylinder(10, 2, 2, 48) - Manifold.cylinder(10, 1.6, 1.6, 48),
        "round": Manifold.cylinder(10, 0.2, 0.2, 48),
    }
    violations, sections = judged(shapes[shape], part=table(10, corner=(-10, -10)))
    assert violations == []
    assert sections >= 20


@pytest.mark.parametrize("thickness", [0.02, 0.1, 0.2])
def test_a_fin_on_a_thick_post_is_found(thickness):
    fin = post(2) + box((2, thickness, 10), (6.9, 6, 0))
    (violation,) = judged(fin)[0]
    assert violation.promise == LEAST_WALL
    assert "fin" in violation.message


def test_a_tapered_needle_is_found_between_the_ends():
    assert LEAST_WALL in promises(Manifold.cylinder(10, 1.0, 0.02, 32).translate((5, 5, 0)))


def test_a_small_section_is_found_although_it_is_thick_enough():
    assert promises(post(0.35), least_contact_mm2=0.25) == {LEAST_CONTACT}
    assert promises(post(0.55), least_contact_mm2=0.25) == set()


def test_what_is_one_with_a_wall_of_the_part_is_judged_with_the_part():
    part = table(10) + box((3, 20, 10), (0, 0, 0))
    beside = box((0.1, 4, 10), (2.99, 5, 0))
    assert promises(beside, part=part) == set()
    assert LEAST_WALL in promises(beside.translate((1, 0, 0)), part=part)


def test_points_have_their_own_least_size_only_below_the_part():
    cone = post(1, height=8) + Manifold.cylinder(2.1, 0.5, 0.1, 24).translate((5.5, 5.5, 8))
    sizes = SupportSizes(tip_width_mm=0.2, tip_height_mm=2.0)
    assert promises(cone, least_wall_mm=0.6) != set()
    assert promises(cone, sizes=sizes, least_wall_mm=0.6) == set()
    low = post(1, height=5) + Manifold.cylinder(5.1, 0.5, 0.1, 24).translate((5.5, 5.5, 5))
    short = SupportSizes(tip_width_mm=0.2, tip_height_mm=1.0)
    assert promises(low, sizes=short, least_wall_mm=0.6) != set()


def test_a_support_with_sizes_of_its_own_is_judged_by_them():
    pointed = post(2, height=9.0) + box((0.12, 0.12, 1.2), (6, 6, 8.95))
    tips = SupportSizes(tip_width_mm=0.1, tip_height_mm=1.5)
    build = build_of([table(10)], [pointed, pointed.translate((5, 0, 0))], **RULES)
    first, second = build.supports
    own = replace(build, supports=(first, replace(second, name="pointed", sizes=tips)))
    assert {each.subject for each in check_least_section(own, Stop())[0]} == {first.name}


def test_without_rules_nothing_is_judged():
    assert judged(post(0.05), least_wall_mm=0.0, least_contact_mm2=0.0) == ([], 0)
