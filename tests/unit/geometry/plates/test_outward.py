"""Simplified polygons contain the given ones, are near them, and have fewer corners."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, FillRule, JoinType
from tests.shared.examples import examples
from tests.shared.plates import star

from amprep.geometry.plates.outward import simplify_outward


@examples(60)
@given(seed=st.integers(0, 10**6), tolerance=st.floats(0.01, 0.6))
def test_the_result_contains_the_polygons_and_is_within_the_tolerance(seed, tolerance):
    rng = np.random.default_rng(seed)
    region = CrossSection([star(rng, 40, 10.0)]).offset(0.3, JoinType.Round, 2.0, 32) - CrossSection(
        [star(rng, 12, 3.0)]
    )
    loops = [np.asarray(loop) for loop in region.to_polygons()]
    simple = CrossSection(simplify_outward(loops, tolerance), FillRule.Positive)
    assert (region - simple).area() < 1e-6
    assert (simple - region.offset(1.001 * tolerance, JoinType.Round, 2.0, 256)).area() < 1e-2 * tolerance


def test_a_circle_of_many_corners_keeps_few():
    circle = np.asarray(CrossSection.circle(10.0, 400).to_polygons()[0])
    assert len(simplify_outward([circle], 0.05)[0]) < 64


def test_a_rectangle_stays_as_it_is():
    rectangle = np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 3.0], [0.0, 3.0]])
    assert sorted(map(tuple, simplify_outward([rectangle], 1.0)[0])) == sorted(map(tuple, rectangle))
