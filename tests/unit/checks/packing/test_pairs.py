"""Distances on trees and the intersections and gaps of manifold3d are two opinions that agree on every pair."""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.solids import arrays

from amprep.checks.packing.pairs import PairCounts, PlacedBody, judge_pairs
from amprep.geometry.meshes.box_tree import box_tree
from amprep.geometry.meshes.distance import near_pairs, solid_distance
from amprep.model import Stop

TOLERANCE = 1e-3
CLEARANCES = (0.0, 0.5, 3.0)


def hollow():
    return Manifold.cube([20, 20, 20], center=True) - Manifold.cube([16, 16, 16], center=True)


def two_cubes():
    return Manifold.cube([2, 2, 2]) + Manifold.cube([2, 2, 2]).translate([6, 0, 0])


SHAPES = (
    lambda: Manifold.cube([4, 6, 8]),
    lambda: Manifold.cube([5, 5, 5], center=True),
    lambda: Manifold.cylinder(9, 4, 2, 24),
    lambda: Manifold.sphere(3, 24),
    lambda: Manifold.cylinder(6, 8, 8, 32) - Manifold.cylinder(6, 6, 6, 32),
    lambda: Manifold.cube([9, 9, 3]) - Manifold.cube([6, 6, 3]).translate([3, 3, 0]),
    hollow,
    two_cubes,
)
"""Makers, because solids in a module outlive manifold3d."""


class Judged(NamedTuple):
    gap: float
    counts: PairCounts


def body(solid):
    vertices, triangles = arrays(solid)
    return PlacedBody(vertices, lambda: box_tree(vertices, triangles), lambda: solid)


def judge(one, other, needed):
    """Return the gap that the judge reports, or infinity, and how it judged the pair."""
    bodies = [body(one), body(other)]
    lo, hi = (np.array([each.bounds[side] for each in bodies]) for side in (0, 1))
    pairs = near_pairs(lo, hi, needed - TOLERANCE)
    found = judge_pairs(bodies, pairs, np.full(len(pairs), needed), TOLERANCE, Stop())
    assert found.left == 0
    return Judged(found.close[0].gap if found.close else np.inf, found.counts)


def expect_agreement(one, other, needed):
    expected, gap = solid_distance(one, other, needed), judge(one, other, needed).gap
    if abs(expected - (needed - TOLERANCE)) < 1e-7:
        return  # rounding decides
    if expected < needed - TOLERANCE:
        assert gap == pytest.approx(expected, abs=1e-5)
    else:
        assert gap == np.inf


@examples(300)
@given(
    st.sampled_from(SHAPES),
    st.sampled_from(SHAPES),
    st.tuples(*[st.floats(-13, 13)] * 3),
    st.floats(0, 360),
    st.sampled_from(CLEARANCES),
)
def test_both_opinions_agree_on_random_pairs(one, other, shift, angle, needed):
    expect_agreement(one(), other().rotate([angle, 0.7 * angle, 0.3 * angle]).translate(shift), needed)


@examples(300)
@given(
    st.sampled_from(SHAPES),
    st.sampled_from(SHAPES),
    st.tuples(*[st.integers(-12, 12)] * 3),
    st.sampled_from((0, 90, 180)),
    st.sampled_from(CLEARANCES),
)
def test_both_opinions_agree_where_faces_are_coplanar_and_edges_touch(one, other, shift, angle, needed):
    expect_agreement(one(), other().rotate([0, 0, angle]).translate(shift), needed)


@examples(60)
@given(st.sampled_from(SHAPES), st.integers(0, 2), st.floats(-0.01, 0.01), st.sampled_from(CLEARANCES))
def test_both_opinions_agree_near_the_limit(make, axis, error, needed):
    solid = make()
    low, high = np.split(np.array(solid.bounding_box()), 2)
    shift = np.zeros(3)
    shift[axis] = high[axis] - low[axis] + needed + error
    expect_agreement(solid, solid.translate(shift), needed)


def test_a_solid_inside_another_overlaps_it_and_one_in_its_cavity_does_not():
    block, peg = Manifold.cube([20, 20, 20], center=True), Manifold.cube([4, 4, 4], center=True)
    assert judge(block, peg, 0.0).gap < -1.0
    assert judge(peg, block, 3.0).gap < -1.0
    assert judge(hollow(), peg, 3.0).gap == np.inf
    assert judge(hollow(), peg.translate([4, 0, 0]), 3.0).gap == pytest.approx(2.0)
    assert judge(hollow(), peg.translate([6, 0, 0]), 0.0).gap == np.inf


def test_one_component_of_a_part_inside_another_is_found():
    # the cubes of the part are 4 apart: the block contains one of them and is far from the other
    block = Manifold.cube([3.4, 4, 4]).translate([5.3, -1, -1])
    assert judge(two_cubes(), block, 0.5).gap < -0.1
    assert judge(block, two_cubes(), 0.5).gap < -0.1


def test_equal_cubes_in_a_row_that_overlap_by_half_are_found():
    # all edges of one cube are in faces of the other, so no edge pierces the inside of a triangle
    cube = Manifold.cube([4, 4, 4])
    assert judge(cube, cube.translate([2, 0, 0]), 0.0).gap == pytest.approx(-1.0)
    assert judge(cube, cube, 0.0).gap < -1.0


def test_an_overlap_up_to_the_tolerance_is_contact():
    cube = Manifold.cube([4, 4, 4])
    assert judge(cube, cube.translate([4 - 0.9 * TOLERANCE, 0, 0]), 0.0).gap == np.inf
    assert judge(cube, cube.translate([4 - 1.2 * TOLERANCE, 0, 0]), 0.0).gap < -TOLERANCE


def test_solids_are_intersected_only_where_surfaces_meet_or_contain_each_other():
    cube = Manifold.cube([4, 4, 4])
    assert judge(cube, cube.translate([9, 0, 0]), 3.0).counts == PairCounts(0, 0, 0)
    ball = Manifold.sphere(2, 24)
    assert judge(ball, ball.translate([3.2, 3.2, 0]), 0.5).counts == PairCounts(0, 1, 0)
    assert judge(cube, cube.translate([3.5, 0, 0]), 0.0).counts == PairCounts(0, 0, 1)
    assert judge(cube.scale([3, 3, 3]), cube.translate([4, 4, 4]), 0.0).counts == PairCounts(0, 0, 1)
    counts = PairCounts(1, 2, 3) + PairCounts(10, 20, 30)
    assert str(counts) == "11 pairs by their enclosing boxes, 22 by their triangles, 33 by their solids"
    assert str(PairCounts(boxes=1, solids=2)) == "1 pair by their enclosing boxes, 2 by their solids"


def test_pairs_after_a_stop_are_counted_as_left():
    stop = Stop()
    stop.cancelled.set()
    cube = Manifold.cube([4, 4, 4])
    bodies = [body(cube), body(cube), body(cube)]
    found = judge_pairs(bodies, [(0, 1), (1, 2)], np.zeros(2), TOLERANCE, stop)
    assert found.left == 2
    assert not found.close
