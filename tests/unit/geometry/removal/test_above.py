"""What is above a body, against the queries on trees."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.removal import blocking_of, box, cup
from tests.shared.solids import arrays

from amprep.geometry.removal import above
from amprep.geometry.removal.above import is_above
from amprep.geometry.removal.blocking import SETBACK

UP = np.array([[0.0, 0.0, 1.0]])


def triangles(solid):
    vertices, faces = arrays(solid)
    return vertices[faces]


@examples(40)
@given(st.integers(0, 10**6))
def test_answers_are_those_of_the_trees(seed):
    rng = np.random.default_rng(seed)
    kinds = [
        box((0, 0, 0), (8, 8, 8)) - box((2, 2, -1), (6, 9, 5)),
        Manifold.sphere(4, 12),
        box((0, 0, 0), (3, 12, 2)),
    ]
    lower, upper = (
        kinds[rng.integers(3)]
        .rotate(rng.uniform(0, 360, 3).tolist())
        .translate(rng.uniform(0, 12, 3).tolist())
        for _ in range(2)
    )
    if (lower ^ upper).volume() > 0.0:
        upper = upper.translate([0, 0, 30])
    blocking = blocking_of([lower, upper], UP)
    expected = blocking.travel(0, 1, UP[0]) < np.inf
    assert is_above(triangles(upper), triangles(lower), SETBACK) == expected


@pytest.mark.parametrize("shift", [(0, 0), (3, 0), (2, 2), (4, 4)])
def test_boxes_with_common_edges_are_above_one_another_if_their_shadows_overlap(shift):
    lower, upper = box((0, 0, 0), (4, 4, 4)), box((*shift, 4), (shift[0] + 4, shift[1] + 4, 8))
    assert is_above(triangles(upper), triangles(lower), SETBACK) == (shift != (4, 4))
    assert not is_above(triangles(lower), triangles(upper), SETBACK)


def test_stacked_cups_are_above_in_one_order_only():
    assert is_above(triangles(cup(3)), triangles(cup(0)), SETBACK)
    assert not is_above(triangles(cup(0)), triangles(cup(3)), SETBACK)


def test_too_many_pairs_are_left_to_the_trees(monkeypatch):
    monkeypatch.setattr(above, "MOST_PAIRS", 3)
    assert is_above(triangles(cup(3)), triangles(cup(0)), SETBACK) is None
    order = blocking_of([cup(0), cup(3)], UP)
    assert order.is_blocked(0, 1, 0)
    assert not order.is_blocked(1, 0, 0)
