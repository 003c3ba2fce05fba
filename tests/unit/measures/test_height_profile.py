"""The height profile and its figures."""

import numpy as np
import pytest

from amprep.measures.height_profile import NO_PROFILE, HeightProfile, measure_profile
from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart
from amprep.testing.problems import box_mesh

SETTINGS = BuildSettings("b", BuildVolume(np.full(3, 100.0)))


def placed(low, high):
    mesh = box_mesh(low, high)
    return PlacedPart("p", Part("p", mesh, mesh.signed_volume), np.eye(4))


def test_the_profile_of_boxes_is_the_sum_of_their_areas():
    parts = (placed([0, 0, 2], [10, 10, 12]), placed([20, 0, 7], [30, 5, 22]))
    profile = measure_profile(Build(SETTINGS, parts))
    assert profile.low == 2.0
    heights = profile.low + profile.spacing * (np.arange(len(profile.areas)) + 0.5)
    expected = np.where(heights < 12, 100.0, 0.0) + np.where(heights > 7, 50.0, 0.0)
    np.testing.assert_allclose(profile.areas, expected)
    assert profile.areas.sum() * profile.spacing == pytest.approx(1750.0, rel=0.01)


def test_figures_are_relative_to_the_mean():
    profile = HeightProfile(0.0, 1.0, np.array([1.0, 1.0, 3.0, 3.0]))
    assert (profile.mean, profile.variation, profile.largest, profile.largest_jump) == (2.0, 0.5, 1.5, 1.0)
    even = HeightProfile(0.0, 1.0, np.full(4, 7.0))
    assert (even.variation, even.largest, even.largest_jump) == (0.0, 1.0, 0.0)


def test_a_build_without_parts_has_no_profile():
    profile = measure_profile(Build(SETTINGS, ()))
    assert (profile.mean, profile.variation, profile.largest, profile.largest_jump) == (0.0, 0.0, 0.0, 0.0)
    assert profile is NO_PROFILE
