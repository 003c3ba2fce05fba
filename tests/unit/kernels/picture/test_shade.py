"""The shading kernels, as plain Python, on cases whose result is known."""

import numpy as np
import pytest
from tests.shared.kernels import plain

from amprep.kernels.picture.rasterise import DepthBuffer
from amprep.kernels.picture.shade import (
    PART,
    Facets,
    Openness,
    PlateShape,
    light_facets,
    lit_fraction,
    openness_at,
    outline_at,
    plate_tone,
)

FRONT = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
"""Axes of a viewer at -y: right is x, down is -z, away is y."""


def facets_of(count, owner=None):
    return Facets(
        np.zeros((count, 3), np.float32),
        np.zeros((count, 4), np.float32),
        np.full(count, PART, np.uint8),
        np.zeros(count, np.int32) if owner is None else np.array(owner, np.int32),
        np.ones((count, 3), np.float32),
    )


def test_a_facet_that_faces_the_viewer_has_the_same_depth_at_all_pixels_and_full_light():
    facets = facets_of(1)
    square = np.array([[0.0, 5, 0], [1, 5, 0], [0, 5, 1]])
    plain(light_facets)(square, np.array([[0, 1, 2]], np.int32), FRONT, FRONT[2], 10.0, facets)
    assert facets.normals[0].tolist() == [0.0, -1.0, 0.0]
    assert facets.light[0, 0] == pytest.approx(0.68), "the sun is behind the viewer"
    assert facets.light[0, 2:].tolist() == [0.0, 0.0]


def test_the_depth_of_a_slope_of_45_degrees_grows_by_a_pixel_for_each_pixel_up():
    facets = facets_of(1)
    slope = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 1]])
    plain(light_facets)(slope, np.array([[0, 1, 2]], np.int32), FRONT, FRONT[2], 10.0, facets)
    assert facets.light[0, 2] == pytest.approx(0.0)
    assert facets.light[0, 3] == pytest.approx(-0.1), "10 pixels are 1 mm, and rows grow downwards"


def test_both_sides_of_a_facet_are_lit_alike():
    points = np.array([[0.0, 0, 0], [1, 0.2, 0], [0, 1, 1]])
    lights = []
    for triangle in ([0, 1, 2], [0, 2, 1]):
        facets = facets_of(1)
        plain(light_facets)(points, np.array([triangle], np.int32), FRONT, FRONT[2], 10.0, facets)
        lights.append(facets.light[0])
    np.testing.assert_array_equal(*lights)


def test_light_is_interpolated_between_shadow_pixels_and_full_outside_the_map():
    shadow = np.full((4, 4), 10.0, np.float32)
    shadow[:, 2:] = 1.0
    fractions = [plain(lit_fraction)(shadow, column, 1.0, 5.0, 0.1) for column in (0.0, 1.25, 1.5, 2.0, -3.0)]
    assert fractions == pytest.approx([1.0, 0.75, 0.5, 0.0, 1.0])


def test_a_plane_is_open_and_the_bottom_of_a_pit_is_not():
    offsets = np.tile(np.array([[0, 2], [0, -2], [2, 0], [-2, 0]]), (4, 1, 1))
    openness = Openness(offsets, 3.0)
    plane = np.full((9, 9), 5.0, np.float32)
    assert plain(openness_at)(plane, 4, 4, 0.0, 0.0, openness) == 1.0
    pit = np.full((9, 9), 2.0, np.float32)
    pit[3:6, 3:6] = 5.0
    assert plain(openness_at)(pit, 4, 4, 0.0, 0.0, openness) == pytest.approx(0.0)
    sloped = (5.0 + 0.5 * np.arange(9)[None, :] * np.ones((9, 1))).astype(np.float32)
    assert plain(openness_at)(sloped, 4, 4, 0.5, 0.0, openness) == 1.0, "its own slope does not close it"


def test_outlines_are_found_at_the_background_at_other_meshes_and_at_steps_and_creases_within_a_mesh():
    ids = np.array([[0, 0, 1, 1, 2, 2, -1]], np.int32).repeat(3, axis=0)
    depth = np.array([[1, 1, 1, 1, 9, 9, np.inf]], np.float32).repeat(3, axis=0)
    facets = facets_of(3, owner=[0, 0, 0])
    facets.normals[:] = [[0, -1, 0], [1, 0, 0], [1, 0, 0]]
    buffer = DepthBuffer(depth, ids)
    lines = [plain(outline_at)(buffer, 1, column, 0.0, 0.0, facets, 1.5) for column in range(6)]
    assert lines == [0, 1, 1, 2, 0, 2]
    other = facets._replace(owner=np.array([0, 1, 1], np.int32))
    near = DepthBuffer(np.where(ids == 1, np.float32(1.2), depth), ids)
    assert plain(outline_at)(near, 1, 1, 0.0, 0.0, other, 1.5) == 2, "the mesh behind is another one"
    assert plain(outline_at)(near, 1, 2, 0.0, 0.0, other, 1.5) == 0, "drawn once, on the nearer mesh"


def test_the_plate_has_an_edge_lines_every_10_and_50_mm_and_nothing_outside():
    square = PlateShape(120.0, 120.0, False, 0.1)
    points = [(-1.0, 5.0), (0.1, 60.0), (50.0, 33.0), (20.0, 33.0), (24.0, 33.0)]
    assert [plain(plate_tone)(x, y, square) for x, y in points] == [-1.0, 0.35, 0.60, 0.82, 1.0]
    disc = PlateShape(120.0, 120.0, True, 0.1)
    assert plain(plate_tone)(5.0, 5.0, disc) == -1.0
    assert plain(plate_tone)(64.0, 57.0, disc) == 1.0
