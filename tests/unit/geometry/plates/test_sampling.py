"""Sampled outlines have the distances of the polygons, and points on all of their sides and inside."""

import numpy as np
import pytest
from manifold3d import CrossSection
from tests.shared.plates import centred, distance_of, region_of, star

from amprep.geometry.plates.sampling import sample_outlines
from amprep.kernels.plates.records import PHASES, UNITS


def test_distances_are_those_to_the_polygon_and_negative_inside():
    outline = centred(star(np.random.default_rng(2), 9, 6.0))
    sampled = sample_outlines([outline], [0.5], 0.8, 0.0)
    nx, ny = 2 * sampled.cells[0] + 1
    values = sampled.distance.reshape(PHASES, PHASES, nx, ny)
    region, rng = region_of(outline), np.random.default_rng(4)
    for _ in range(40):
        i, j = rng.integers(0, PHASES * nx), rng.integers(0, PHASES * ny)
        x, y = (np.array([i, j]) - PHASES * sampled.cells[0]) * 0.8 / PHASES
        dot = CrossSection.square((2e-4, 2e-4), True).translate((x, y))
        found = values[i % PHASES, j % PHASES, i // PHASES, j // PHASES] * 0.8 / UNITS
        inside = (dot ^ region).area() > 0.5 * dot.area()
        outer = CrossSection.square((60.0, 60.0), True) - region
        expected = -distance_of(dot, outer, 20.0) if inside else distance_of(dot, region, 20.0)
        assert found == pytest.approx(expected, abs=5e-3)


def test_points_are_near_all_sides_and_some_are_inside():
    outline = centred(np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 5.0], [0.0, 5.0]]))
    sampled = sample_outlines([outline], [0.0], 1.0, 0.0)
    points = sampled.point / PHASES
    edge = np.abs(np.abs(points) - [4.5, 2.5]).min(axis=1) < 0.2
    assert edge.sum() >= 2 * (9 + 5) / 0.5
    assert (~edge).sum() >= 4
    assert sampled.bed == -1


def test_the_edge_of_a_round_plate_is_the_last_outline():
    one = centred(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    assert sample_outlines([one, one], [0.0, 0.0], 0.5, 10.0).bed == 1
