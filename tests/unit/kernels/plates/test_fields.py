"""Depths that fields give are the clearance less the distance of the polygons, and positive where these overlap."""

import numpy as np
import pytest
from numba import njit
from tests.shared.plates import centred, distance_of, region_of, star

from amprep.geometry.plates.sampling import sample_outlines
from amprep.kernels.plates.fields import depth_at
from amprep.kernels.plates.records import UNKNOWN, FieldCache, PlateShapes


@njit
def depth_of(outlines, cache, shapes, one, other, x, y):
    return depth_at(outlines, cache, shapes, one, other, x, y, np.zeros(4, np.int64))


def scene(polygons, clearance, step, values=200_000):
    outlines = sorted((centred(*loops) for loops in polygons), key=lambda each: each.area)
    m = len(outlines)
    sampled = sample_outlines(outlines, [clearance] * m, step, 0.0)
    cache = FieldCache(np.empty(values, np.int16), np.full((m, m, 4), UNKNOWN), np.zeros(2, np.int64))
    ends = np.zeros((4 * m, 2))
    shapes = PlateShapes(np.repeat(np.arange(m), 4), np.tile(np.arange(4), m), ends, ends)
    return outlines, sampled, cache, shapes


@pytest.mark.parametrize("clearance", [0.0, 1.0])
def test_depths_of_separate_outlines_are_the_clearance_less_the_distance(clearance):
    rng = np.random.default_rng(8)
    outlines, sampled, cache, shapes = scene([(star(rng, 7, 6.0),), (star(rng, 9, 9.0),)], clearance, 0.4)
    compared = 0
    while compared < 60:
        one, other = rng.integers(0, 8, 2)
        offset = rng.uniform(-14.0, 14.0, 2)
        a = region_of(outlines[one // 4], offset, int(one % 4))
        b = region_of(outlines[other // 4], (0.0, 0.0), int(other % 4))
        found = depth_of(sampled, cache, shapes, one, other, *offset)
        overlap = (a ^ b).area()
        if overlap > 0.5:
            assert found > 0.5 * clearance
        elif overlap < 1e-9:
            assert found == pytest.approx(max(0.0, clearance - distance_of(a, b, 40.0)), abs=0.2)
        compared += overlap < 1e-9


def test_a_part_is_free_inside_a_ring_and_overlaps_a_full_disc():
    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    _, sampled, cache, shapes = scene(
        [(2.0 * circle,), (10.0 * circle, 6.0 * circle[::-1]), (10.2 * circle,)], 1.0, 0.5
    )
    small, tube, full = 0, 4, 8
    assert depth_of(sampled, cache, shapes, small, tube, 0.0, 0.0) == 0.0
    assert depth_of(sampled, cache, shapes, tube, small, 2.5, 0.0) == 0.0
    assert depth_of(sampled, cache, shapes, small, tube, 4.0, 0.0) > 0.5
    assert depth_of(sampled, cache, shapes, small, full, 0.0, 0.0) > 8.0


def test_equal_outlines_on_one_another_overlap_deeply():
    square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    _, sampled, cache, shapes = scene([(square,)], 0.5, 0.5)
    assert depth_of(sampled, cache, shapes, 0, 0, 0.0, 0.0) > 9.0


def test_fields_that_were_dropped_are_computed_again():
    rng = np.random.default_rng(1)
    polygons = [(star(rng, 7, 4.0),) for _ in range(4)]
    _, sampled, cache, shapes = scene(polygons, 0.5, 0.4)
    _, _, small, _ = scene(polygons, 0.5, 0.4, values=8000)
    for one, other in rng.integers(0, 16, (200, 2)):
        x, y = rng.uniform(-6.0, 6.0, 2)
        expected = depth_of(sampled, cache, shapes, one, other, x, y)
        assert depth_of(sampled, small, shapes, one, other, x, y) == expected
    assert small.used[1] > 0
