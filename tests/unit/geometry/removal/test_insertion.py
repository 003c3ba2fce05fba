"""Bodies that are let down from above come to rest at the clearance, for an independent judge."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.removal import box, cup
from tests.shared.solids import arrays

from amprep.geometry.removal.bodies import CollisionShape, movable_body
from amprep.geometry.removal.insertion import box_drops, drop


def body_of(solid):
    return movable_body([(CollisionShape(*arrays(solid)), np.eye(4))])


def test_a_cup_is_let_down_into_another():
    below, above = body_of(cup(0)), body_of(cup(0))
    height = drop(above, [below], np.zeros(2), 0.0, 0.0)
    assert 1.9 < height < 2.1, "bottoms are 2 mm thick"
    assert box_drops(above, [below], np.zeros((1, 2)), 0.0, 0.0)[0] == 20.0


def test_beside_others_a_body_comes_to_rest_on_the_floor():
    body, other = body_of(box((0, 0, 5), (10, 10, 15))), body_of(box((0, 0, 0), (10, 10, 15)))
    assert drop(body, [other], np.array([12.0, 0.0]), 3.0, 1.0) == -2.0
    assert drop(body, [], np.zeros(2), 3.0, 1.0) == -2.0


@examples(10)
@given(st.integers(0, 10**6))
def test_a_body_at_rest_keeps_the_clearance_and_could_hardly_be_lower(seed):
    rng = np.random.default_rng(seed)
    margin = float(rng.choice([0.5, 2.0]))
    others = [Manifold.sphere(6, 16).translate(rng.uniform(0, 20, 3).tolist()) for _ in range(3)]
    solid = (box((0, 0, 0), (8, 8, 8)) - box((2, 2, -1), (6, 6, 6))).rotate(rng.uniform(0, 90, 3).tolist())
    body, offset = body_of(solid), rng.uniform(0, 16, 2)
    bodies = [body_of(other) for other in others]
    height = drop(body, bodies, offset, -30.0, margin)
    assert height <= box_drops(body, bodies, offset[None], -30.0, margin)[0] + 1e-9

    def gap(z):
        moved = solid.translate([*offset.tolist(), z])
        return min(moved.min_gap(other, 5.0) for other in others)

    assert gap(height) >= margin - 1e-5
    on_floor = solid.bounding_box()[2] + height <= -30.0 + 1e-9
    assert on_floor or gap(height - 0.05) < margin
