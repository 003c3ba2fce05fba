"""Boxes that stay parallel to the axes: travel by closed form against small steps."""

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.queries import collide, travel, turn

from amprep.kernels.annealing.box_shapes import BoxShapes

small = st.integers(-6, 6).map(float)
half = st.integers(1, 4).map(float)
three = st.tuples(small, small, small)
boxes = st.lists(st.tuples(three, st.tuples(half, half, half)), min_size=1, max_size=2)


def pose_at(x, y, z):
    return np.array([1.0, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z])


def shapes_of(*sets):
    return BoxShapes(
        np.array([c for s in sets for c, _ in s]),
        np.array([h for s in sets for _, h in s]) / 2.0,
        np.cumsum([0] + [len(s) for s in sets]),
    )


@examples(60)
@given(boxes, boxes, three, three.filter(any), st.sampled_from([0.0, 0.75]))
def test_travel_ends_where_small_steps_collide_first(one, other, at, direction, margin):
    shapes, still = shapes_of(one, other), pose_at(0, 0, 0)
    assume(not collide(shapes, 0, pose_at(*at), 1, still, margin))
    ray = np.array(direction) / np.linalg.norm(direction)
    found = travel(shapes, 0, pose_at(*at), 1, still, tuple(ray), margin, 20.0)
    steps = np.arange(0.02, 20.0, 0.02)
    hits = (collide(shapes, 0, pose_at(*(np.array(at) + t * ray)), 1, still, margin) for t in steps)
    first = next((t for t, hit in zip(steps, hits, strict=True) if hit), 20.0)
    assert found <= first + 1e-9
    assert found >= first - 0.021 or not collide(
        shapes, 0, pose_at(*(np.array(at) + (found - 1e-6) * ray)), 1, still, margin
    )


def test_touching_boxes_slide_along_each_other_but_not_into_each_other():
    shapes = shapes_of([((0, 0, 0), (2, 2, 2))], [((0, 0, 0), (2, 2, 2))])
    args = shapes, 0, pose_at(0, 0, 2), 1, pose_at(0, 0, 0)
    assert travel(*args, (0.0, 0.0, -1.0), 0.0, 9.0) <= 1e-6
    assert travel(*args, (1.0, 0.0, 0.0), 0.0, 9.0) == 9.0
    assert travel(*args, (0.0, 0.0, 1.0), 0.0, 9.0) == 9.0


def test_the_engine_is_chosen_by_the_kind_of_shapes():
    shapes = shapes_of([((0, 0, 0), (2, 2, 2))], [((5, 0, 0), (2, 2, 2))])
    pose = pose_at(0, 0, 0)
    assert abs(travel(shapes, 0, pose, 1, pose, (1.0, 0.0, 0.0), 0.0, 9.0) - 3.0) < 1e-6
    assert collide(shapes, 0, pose, 1, pose, 3.5)
    assert turn(shapes, 0, pose, 1, pose, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0, 1.0) == 0.0
