"""Beds of slicers become build volumes: what is free in amprep is on the bed, and hardly anything of it is lost."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.errors import InputError
from amprep.printers.imported.beds import profile_of_bed

L_SHAPE = [[0, 0], [200, 0], [200, 100], [80, 100], [80, 200], [0, 200]]


def inside(outline, points):
    """Tell which points lie inside a polygon by the number of edges to their right: an oracle of another kind."""
    result = np.zeros(len(points), bool)
    for (x0, y0), (x1, y1) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        crosses = (points[:, 1] >= min(y0, y1)) & (points[:, 1] < max(y0, y1))
        result ^= crosses & (points[:, 0] < x0 + (points[:, 1] - y0) / (y1 - y0) * (x1 - x0))
    return result


def free(profile, points):
    """Tell which points in machine coordinates amprep may use."""
    local = points - profile.origin_mm
    result = (local >= 0).all(axis=1) & (local <= profile.size_mm[:2]).all(axis=1)
    for x0, y0, _, x1, y1, _ in profile.zones:
        result &= ~((local > (x0, y0)) & (local < (x1, y1))).all(axis=1)
    return result


def circle(radius, count=72):
    angle = 2 * np.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def test_a_rectangle_anywhere_is_a_box_with_its_corner_as_origin():
    outline = np.array([[-107.0, -93], [107, -93], [107, 93], [-107, 93]])
    profile = profile_of_bed("BIBO", outline, 160.0, "")
    assert (profile.shape, profile.size_mm, profile.origin_mm, profile.zones) == (
        "box",
        (214.0, 186.0, 160.0),
        (-107.0, -93.0),
        (),
    )


@pytest.mark.parametrize("turned", [1, -1])
def test_many_corners_on_a_circle_are_a_cylinder(turned):
    profile = profile_of_bed("delta", circle(130.0)[::turned] + (20.0, 0.0), 300.0, "")
    assert (profile.shape, profile.size_mm, profile.origin_mm) == (
        "cylinder",
        (260.0, 300.0),
        (-110.0, -130.0),
    )


@examples(60)
@given(
    outline=st.one_of(
        st.just(np.array(L_SHAPE, float)),
        st.lists(st.floats(60, 150), min_size=5, max_size=11).map(
            lambda radii: circle(1.0, len(radii)) * np.array(radii)[:, None]
        ),
    ),
    turned=st.sampled_from([1, -1]),
)
def test_what_is_free_is_on_the_bed_and_little_of_the_bed_is_lost(outline, turned):
    outline = outline[::turned]
    profile = profile_of_bed("odd", outline, 100.0, "")
    rng = np.random.default_rng(1)
    points = rng.uniform(outline.min(axis=0), outline.max(axis=0), (4000, 2))
    on_bed, usable = inside(outline, points), free(profile, points)
    assert not (usable & ~on_bed).any()
    assert (on_bed & ~usable).sum() <= 0.12 * on_bed.sum()


def test_areas_on_the_bed_are_forbidden():
    triangle = np.array([[10.0, 10], [60, 10], [10, 60]])
    square = np.array([[0.0, 0], [200, 0], [200, 200], [0, 200]])
    profile = profile_of_bed("clips", square, 100.0, "", [triangle])
    points = np.random.default_rng(2).uniform(0, 200, (4000, 2))
    assert not (free(profile, points) & inside(triangle, points)).any()
    assert free(profile, points)[(points > 62).any(axis=1)].all()


@pytest.mark.parametrize(
    ("outline", "height"),
    [
        (np.zeros((2, 2)), 9.0),
        (np.zeros((4, 2)), 9.0),
        (np.array(L_SHAPE, float), -1.0),
        (np.full((4, 2), np.nan), 9.0),
    ],
)
def test_a_bed_without_a_size_is_refused(outline, height):
    with pytest.raises(InputError, match="broken"):
        profile_of_bed("broken", outline, height, "")


@pytest.mark.parametrize("area", [np.full((4, 2), np.nan), np.zeros((1001, 2))])
def test_areas_that_cannot_be_kept_free_are_refused(area):
    with pytest.raises(InputError, match="finite corners"):
        profile_of_bed("broken", np.array(L_SHAPE, float), 9.0, "", [area])
