"""Drift: supports below the overhangs that they carry keep the promise; those that wander away do not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold, OpType
from tests.shared.examples import examples
from tests.shared.supported import box, build_of, table

from amprep.checks.supports.drift import check_drift
from amprep.model import Stop
from amprep.model.supports.sizes import SupportSizes

LIMITS = {"rules": "limits", "ledge_mm": 1.0, "bridge_mm": 2.0, "bore_mm": 8.0}
RULES = LIMITS | {"territory": "own", "drift_ratio": 1 / 3, "drift_mm": 15.0}
SIZES = SupportSizes(square_mm=1.0)


def judged(part, body, sizes=SIZES, **rules):
    return check_drift(build_of([part], [body], sizes, **(RULES | rules)), Stop())


def leaning(away, height):
    """A chain of blocks that leans sideways by `away` over its height; it ends below the corner of a table."""
    count = 60
    steps = [
        box((1.5, 1.5, height / count + 0.05), (-0.5 - away * (1 - k / (count - 1)), 5, k * height / count))
        for k in range(count)
    ]
    return Manifold.batch_boolean(steps, OpType.Add)


@given(st.floats(0, 30), st.sampled_from([12.0, 30.0, 60.0]))
@examples(15)
def test_a_support_may_drift_by_a_third_of_its_height_and_at_most_15_mm(away, height):
    found = judged(table(height), leaning(away, height))
    allowed = min(height / 3, 15.0)
    if away + 0.5 <= allowed:
        assert found == []
    elif away > allowed + 3.0:
        assert "too far" in found[0].message


def test_a_column_beside_everything_is_found():
    assert len(judged(table(10), box((1, 1, 5), (40, 40, 0)))) == 1


def test_a_zigzag_is_found_although_its_foot_is_below_the_overhang():
    out_and_back = leaning(8, 20).mirror((0, 0, 1)).translate((0, 0, 20)) + leaning(8, 20).translate(
        (0, 0, 20)
    )
    assert len(judged(table(40), out_and_back, drift_ratio=0.1)) == 1
    assert judged(table(40), box((1, 1, 40), (5, 5, 0)), drift_ratio=0.1) == []


def test_what_the_part_carries_itself_carries_no_support():
    part = box((10, 20, 40), (0, 0, 0)) + box((10.9, 20, 5), (0, 0, 20)) + box((25, 20, 5), (0, 0, 35))
    near = box((1, 1, 20), (10, 5, 0))
    assert judged(part, near.translate((5, 0, 0))) == []
    lower = box((10, 20, 40), (0, 0, 0)) + box((10.9, 20, 5), (0, 0, 20))
    (violation,) = judged(lower, near)
    assert "no overhang" in violation.message


@pytest.mark.parametrize(("span", "needs"), [(2.3, True), (2.6, True), (1.7, False)])
def test_a_narrow_strip_that_needs_support_between_samples_is_found(span, needs):
    middle = 4.45
    sides = box((5, 20, 20), (middle - span / 2 - 5, 0, 0)) + box((5, 20, 20), (middle + span / 2, 0, 0))
    found = judged(
        sides + box((10 + span, 20, 5), (middle - span / 2 - 5, 0, 20)), box((1, 1, 20), (4, 5, 0))
    )
    assert (found == []) == needs


def test_what_only_touches_the_part_along_an_edge_may_need_support():
    """A block hangs from a plate; at its lower edges it touches the side of a shaft without being part of it."""
    shaft = box((10, 20, 20), (-10, 0, 0))
    block = box((1.5, 20, 5), (0, 0, 20)) + box((11.5, 20, 5), (-10, 0, 25))
    column = box((1, 1, 20), (0.2, 9, 0))
    assert judged(shaft + block, column, ledge_mm=2.0, bridge_mm=4.0) == []
    joined = shaft + block + box((10, 20, 5), (-10, 0, 20))
    assert "no overhang" in judged(joined, column, ledge_mm=2.0, bridge_mm=4.0)[0].message


def test_a_base_may_reach_farther_by_its_margin():
    foot = box((1, 1, 10), (0, 0, 0)) + box((9, 9, 0.5), (-4, -4, 0))
    assert len(judged(table(10, corner=(0, 0)), foot.translate((-2.5, 5, 0)))) == 1
    wide = SupportSizes(square_mm=1.0, base_margin_mm=4.0, base_height_mm=0.6)
    assert judged(table(10), foot.translate((-0.5, 5, 0)), sizes=wide) == []


@pytest.mark.parametrize("rules", [{"territory": "shared"}, {"drift_ratio": 0.0, "drift_mm": 0.0}])
def test_without_a_limit_nothing_is_judged(rules):
    assert judged(table(10), box((1, 1, 5), (40, 40, 0)), **rules) == []


@pytest.mark.parametrize(("angle", "carried"), [(44.99, True), (45.01, True), (45.1, False)])
def test_faces_that_rounding_may_make_overhangs_may_be_supported(angle, carried):
    rise = 20.0 * np.tan(np.radians(angle))
    wall = CrossSection([[(-5, 0), (0, 0), (0, 10), (20, 10 + rise), (20, 40), (-5, 40)]])
    part = wall.extrude(10).rotate((90, 0, 0)).translate((0, 10, 0))
    found = judged(part, box((1, 1, 8 + 0.7 * rise), (14, 5, 0)))
    assert (found == []) == carried
