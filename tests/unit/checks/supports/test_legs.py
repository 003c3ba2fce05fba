"""Legs: length over width, between braces, walls and ends."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.supported import box, build_of, table

from amprep.checks.supports.legs import STEP, check_legs, legs_above
from amprep.model import Stop
from amprep.model.supports.sizes import SupportSizes


def legs(body, height=60.0, part=None, limit=10.0, sizes=None):
    build = build_of([table(height) if part is None else part], [body], sizes, leg_ratio=limit)
    assert len(check_legs(build, Stop())) == bool(legs_above(build.supports[0], build, limit))
    return legs_above(build.supports[0], build, limit)


@given(st.floats(0.4, 3.0), st.floats(5.0, 60.0), st.floats(0, 90))
@examples(15)
def test_a_single_post_is_one_leg_with_its_length_and_width(width, height, turn):
    found = legs(box((width, width + 1, height), (0, 0, 0)).rotate((0, 0, turn)), height)
    if height - 2 * STEP > 10.3 * width:
        (leg,) = found
        assert leg.width_mm == pytest.approx(width, rel=0.02)
        assert height - 2 * STEP <= leg.length_mm <= height
    elif height < 10 * width:
        assert found == []


def two_posts(height, braces, width=1.0):
    posts = [box((width, width, height), (x, 5, 0)) for x in (5, 9)]
    struts = [
        box((5.2, width, width), (0, 0, -width)).rotate((0, -45, 0)).translate((5.2, 5, z + 1))
        for z in braces
    ]
    return Manifold.batch_boolean([*posts, *struts], _add())


def _add():
    from manifold3d import OpType

    return OpType.Add


def test_braces_end_legs_and_a_removed_brace_is_found():
    assert len(legs(two_posts(20, []), 20.0)) == 2
    assert legs(two_posts(20, [6, 12]), 20.0) == []
    assert len(legs(two_posts(30, [6, 12]), 30.0)) == 2


@pytest.mark.parametrize("turn", [0, 30, 90])
def test_posts_that_touch_along_an_edge_only_are_legs_of_their_own(turn):
    posts = box((1, 1, 24), (0, 0, 0)) + box((1, 1, 24), (1, 1, 0))
    assert [leg.width_mm for leg in legs(posts.rotate((0, 0, turn)), 24)] == pytest.approx(
        [1.0, 1.0], rel=0.02
    )
    joined = posts + box((1, 1, 24), (1, 0, 0))
    assert legs(joined, 20) == [], "three squares that share sides are two wide"


def test_leaning_legs_count_by_their_height():
    steps = [box((0.8, 0.8, 0.5), (5 + 0.4 * k, 5, 0.45 * k)) for k in range(40)]
    assert len(legs(Manifold.batch_boolean(steps, _add()), 18.0)) == 1


def test_a_wall_of_the_part_holds_a_leg_that_touches_it():
    post = box((1, 1, 30), (5, 5, 0))
    wall = table(30) + box((2, 20, 30), (3.05, 0, 0))
    assert len(legs(post, 30.0)) == 1
    assert legs(post, part=wall) == []
    apart = table(30) + box((2, 20, 30), (2.5, 0, 0))
    assert len(legs(post, part=apart)) == 1


def test_a_wall_beside_half_of_a_leg_leaves_the_other_half():
    post = box((1, 1, 30), (5, 5, 0))
    (leg,) = legs(post, part=table(30) + box((2, 20, 15), (3, 0, 0)))
    assert leg.length_mm == pytest.approx(15, abs=1.1)
    assert legs(post, part=table(30) + box((2, 20, 15), (3, 0, 7))) == []


def post_with_a_foot(foot):
    """Return a post 2 mm wide and 34 mm high, on a foot of 4 mm that is included in its height."""
    return box((2, 2, 34), (5, 5, 0)) + box((4, 4, foot), (4, 4, 0))


def test_a_leg_may_be_wider_below_in_proportion_to_the_length_above():
    assert len(legs(post_with_a_foot(5), 34.0)) == 1
    assert legs(post_with_a_foot(16), 34.0) == []


def test_a_short_wide_place_does_not_divide_a_leg():
    knot = box((2, 2, 60), (5, 5, 0)) + box((4, 4, 2), (4, 4, 30))
    (leg,) = legs(knot, 60.0)
    assert leg.length_mm == pytest.approx(60.0, abs=2 * STEP)
    narrow = box((2, 2, 15), (5, 5, 0)) - box((2, 4, 2), (5.8, 4, 7))
    assert legs(narrow, 15.0) == [], "a short narrow place is none that the whole leg is measured by"


def test_a_narrow_stretch_counts_with_its_own_length_and_a_bend_makes_no_leg_wider():
    waist = box((2, 2, 15), (5, 5, 0)) - box((2, 4, 2), (5.8, 4, 7))
    assert legs(waist, 15.0) == [], "0.8 mm wide for 2 mm, 2 mm wide for 15 mm"
    foot = box((2, 2, 30), (5, 5, 0)) + box((4, 4, 12), (4, 4, 0))
    assert legs(foot, 30.0) == [], "18 mm at 2 mm, 30 mm at 4 mm"
    (leg,) = legs(box((2, 2, 30), (5, 5, 0)) + box((4, 4, 6), (4, 4, 0)), 30.0)
    assert (leg.length_mm, leg.width_mm) == pytest.approx((24, 2), abs=1.0)
    bend = box((2, 2, 30), (5, 5, 0)) + box((4, 4, 4), (4, 4, 13))
    (leg,) = legs(bend, 30.0)
    assert (leg.length_mm, leg.width_mm) == pytest.approx((30, 2), abs=1.0)


def test_where_a_brace_is_still_beside_the_leg_it_is_not_free():
    """The struts are 12.2 mm apart and 1.4 mm high; in plan each leaves its leg over 1 mm more."""
    posts = two_posts(18, [3.0, 15.2])
    for square in (1.0, 2.0):
        free = legs(posts, 18.0, limit=6.0, sizes=SupportSizes(square_mm=square))
        assert [leg.length_mm for leg in free] == pytest.approx([10.0, 10.0], abs=0.5)
    assert legs(posts, 18.0, sizes=SupportSizes(square_mm=1.0)) == []
    assert max(leg.length_mm for leg in legs(posts, 18.0, limit=6.0)) > 11


def test_ends_that_the_part_cuts_and_tips_set_no_width():
    slope = box((2, 2, 17), (5, 5, 0)) - box((6, 6, 6), (0, 0, 0)).rotate((0, -45, 0)).translate((7.2, 4, 15))
    assert legs(slope, 16.0) == []
    pointed = box((2, 2, 12), (5, 5, 0)) + Manifold.cylinder(3.1, 1.0, 0.1, 24).translate((6, 6, 12))
    sizes = SupportSizes(tip_width_mm=0.2, tip_height_mm=3.0)
    assert legs(pointed, 15.0, sizes=sizes) == []


def test_without_a_limit_nothing_is_judged():
    build = build_of([table(60)], [box((0.2, 0.2, 60), (5, 5, 0))])
    assert check_legs(build, Stop()) == []


def test_the_message_names_length_width_and_place():
    build = build_of([table(40)], [box((1, 1, 40), (5, 7, 0))], leg_ratio=10.0)
    (violation,) = check_legs(build, Stop())
    assert "1.00 mm wide" in violation.message
    assert "to 1" in violation.message
    assert np.isin(["5.5", "7.5"], violation.message.replace(",", " ").replace("(", " ").split()).all()
