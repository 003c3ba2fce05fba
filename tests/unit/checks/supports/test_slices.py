"""Contours of many planes at once agree with those that manifold3d cuts one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.solids import PRINTABLE, mesh_of, random_solid
from tests.shared.supported import box

from amprep.checks.supports.slices import slices_of


@given(st.integers(0, 10_000), st.floats(0.13, 0.9))
@examples(25)
def test_areas_and_numbers_of_contours_are_those_of_manifold3d(seed, step):
    solid = random_solid(seed)
    low, high = solid.bounding_box()[2], solid.bounding_box()[5]
    heights = np.arange(low + 0.4321 * step, high, step)
    slices = slices_of(mesh_of(solid), heights)
    for plane, height in enumerate(heights):
        expected = solid.slice(height)
        own = slices.plane == plane
        assert slices.area[own].sum() == pytest.approx(expected.area(), abs=1e-6)
        assert (slices.area[own] > 1e-6).sum() == len([c for c in expected.decompose() if c.area() > 1e-6])


def test_widths_are_those_of_the_hull():
    slices = slices_of(mesh_of(box((7, 2, 5), (0, 0, 0)).rotate((0, 0, 30))), np.array([1.0, 2.0]))
    assert slices.widths_of(np.arange(2)) == pytest.approx([2.0, 2.0], rel=0.01)


def test_a_contour_follows_another_only_where_neither_forks():
    fork = box((10, 2, 4), (0, 0, 0)) + box((2, 2, 8), (0, 0, 0)) + box((2, 2, 8), (8, 0, 0))
    slices = slices_of(mesh_of(fork), np.array([1.0, 3.0, 5.0, 7.0]))
    chains = {(int(slices.plane[c]), int(slices.plane[a])) for c, a in enumerate(slices.above) if a >= 0}
    assert chains == {(0, 1), (2, 3)}


def test_steep_thin_walls_are_followed_although_their_sections_do_not_overlap():
    leaning = box((10, 0.2, 12), (0, 0, 0)).rotate((-50, 0, 0))
    slices = slices_of(mesh_of(leaning), np.arange(1.0, 7.0, 0.5))
    assert (slices.above >= 0).sum() == 11


@pytest.mark.parametrize("name", ["nested balls", "thin box"])
def test_holes_have_negative_areas(name):
    solid = PRINTABLE[name]()
    slices = slices_of(mesh_of(solid), np.array([0.5 * sum(solid.bounding_box()[2::3])]))
    assert (slices.area < 0).any()
    assert (slices.area > 0).any()


def test_planes_beside_the_mesh_cut_nothing():
    assert len(slices_of(mesh_of(Manifold.cube((1, 1, 1))), np.array([-1.0, 3.0])).area) == 0
