"""Depth between samples, as the search sees it: the overlap of two boxes in closed form."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.no_fit import box_shapes, in_box, layout_of, rules_for, state_for

from amprep.geometry.no_fit.pieces import no_fit_solid
from amprep.kernels.no_fit.depth import sample_depth
from amprep.kernels.no_fit.separate import separate

SIZES = [[2, 3, 4], [3, 1, 2]]
PIECES, FIELDS = box_shapes(SIZES, 0.25)


@examples(60)
@given(st.lists(st.floats(-1.0, 5.0), min_size=3, max_size=3))
def test_the_depth_of_two_boxes_is_exact_but_near_edges(offset):
    layout = layout_of([0, 1], [[10, 10, 10], np.array([10, 10, 10]) + offset])
    state, best = state_for(2, 1), layout_of([0, 1], np.zeros((2, 3)))
    room = in_box(SIZES, (30, 30, 30))
    separate(FIELDS, room, rules_for([0, 1]), layout, best, state, 0, 1)
    lo, hi = np.array([-3.0, -1, -2]), np.array([2.0, 3, 4])
    depth = max(0.0, min((offset - lo).min(), (hi - offset).min()))
    assert abs(state.overlap[0, 1] - depth) < 0.25  # less than a step, where sides meet
    assert state.overlap[0, 1] == state.overlap[1, 0]
    sides = np.sort(np.concatenate((offset - lo, hi - offset)))
    if sides[0] > 0.0 and sides[1] > sides[0] + 0.6:
        assert abs(state.overlap[0, 1] - depth) < 1e-5


def test_samples_outside_all_polyhedra_have_the_least_depth():
    out = np.empty((4, 4, 4), np.float32)
    far = np.array([100.0, 100, 100])
    solid = no_fit_solid(PIECES.shapes[0], PIECES.shapes[1], 0.0)
    sample_depth(solid, far, 0.25, np.empty(4, np.float32), out)
    assert (out == np.float32(-0.5)).all()
