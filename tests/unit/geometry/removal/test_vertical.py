"""Free travel upwards and downwards keeps the clearance, for an independent judge."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.removal import box
from tests.shared.solids import arrays

from amprep.geometry.removal.bodies import CollisionShape, movable_body
from amprep.geometry.removal.vertical import too_near, vertical_travel


def body_of(solid, is_boxes=False):
    return movable_body([(CollisionShape(*arrays(solid)), np.eye(4))], is_boxes)


@pytest.mark.parametrize("is_boxes", [True, False])
def test_boxes_stop_at_the_clearance(is_boxes):
    body = body_of(box((0, 0, 10), (5, 5, 15)), is_boxes)
    above, below = (
        body_of(box((2, 2, 20), (9, 9, 25)), is_boxes),
        body_of(box((0, 0, 0), (5, 5, 8)), is_boxes),
    )
    others = [above, below, body_of(box((20, 0, 0), (25, 5, 40)), is_boxes)]
    assert vertical_travel(body, others, 1, 100.0, 1.5) == pytest.approx(3.5, abs=1e-5)
    assert vertical_travel(body, others, -1, 100.0, 1.5) == pytest.approx(0.5, abs=1e-5)
    assert vertical_travel(body, others[2:], 1, 7.0, 1.5) == 7.0


def test_a_box_beside_another_at_the_clearance_moves_freely():
    body, other = body_of(box((0, 0, 10), (5, 5, 15)), True), body_of(box((7, 0, 0), (9, 9, 40)), True)
    assert vertical_travel(body, [other], 1, 100.0, 2.0) == 100.0
    assert vertical_travel(body, [other], 1, 100.0, 2.1) == 0.0


@examples(15)
@given(st.integers(0, 10**6))
def test_travel_is_free_and_longest(seed):
    rng = np.random.default_rng(seed)
    margin, sign = float(rng.choice([0.0, 1.0])), int(rng.choice([-1, 1]))
    others = [Manifold.sphere(5, 12).translate(rng.uniform(-12, 12, 3).tolist()) for _ in range(4)]
    solid = (box((-4, -4, -4), (4, 4, 4)) - box((-2, -2, -6), (2, 2, 6))).rotate(
        rng.uniform(0, 90, 3).tolist()
    )
    others = [other for other in others if solid.min_gap(other, 5.0) > margin]
    travel = vertical_travel(body_of(solid), [body_of(other) for other in others], sign, 20.0, margin)

    def gap(distance):
        moved = solid.translate([0, 0, sign * distance])
        return min((moved.min_gap(other, 5.0) for other in others), default=5.0)

    assert all(gap(distance) >= margin - 1e-4 for distance in np.linspace(0.0, travel, 12))
    assert travel == 20.0 or gap(travel + 0.05) < max(margin, 1e-9)


def test_bodies_are_too_near_below_the_margin_only():
    body = body_of(box((0, 0, 0), (5, 5, 5)))
    for is_boxes in (True, False):
        one = body_of(box((0, 0, 0), (5, 5, 5)), is_boxes)
        assert too_near(one, body_of(box((6, 0, 0), (9, 5, 5)), is_boxes), 1.1)
        assert not too_near(one, body_of(box((6, 0, 0), (9, 5, 5)), is_boxes), 1.0)
        assert too_near(one, body_of(box((4, 4, 4), (9, 9, 9)), is_boxes), 0.0)
        assert not too_near(one, body_of(box((5.8, 5.8, 0), (9, 9, 9)), is_boxes), 1.1)
    assert not too_near(body, body_of(box((5, 0, 0), (9, 5, 5))), 0.0)
