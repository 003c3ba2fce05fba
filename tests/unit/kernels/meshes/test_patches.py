"""The kernels on patches agree with plain Python that uses manifold3d's areas or tests every pair of points."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection
from tests.shared.examples import examples

from amprep.arrays import Floats, Ints
from amprep.kernels.meshes.patches import (
    Patches,
    RaisedPatches,
    colour_patches,
    find_below,
    find_visible,
)

LEAST_AREA = 1e-4
"""mm2; smaller overlaps in plan are left undecided."""


def polygons(rng, count) -> tuple[Floats, Ints]:
    """Return convex patches: regular polygons in random planes, counter-clockwise seen from above."""
    points, start = [], [0]
    for _ in range(count):
        corners = rng.integers(3, 7)
        angle = np.sort(rng.uniform(0, 2 * np.pi, corners))
        radius = rng.uniform(0.2, 1.5)
        plan = radius * np.column_stack([np.cos(angle), np.sin(angle)]) + rng.uniform(0, 3, 2)
        slope, height = rng.uniform(-0.5, 0.5, 2), rng.uniform(0, 5)
        points.append(np.column_stack([plan, height + plan @ slope]))
        start.append(start[-1] + corners)
    return np.concatenate(points), np.array(start, np.int64)


def of_one_column(points, start, first):
    number = np.arange(first, first + len(start) - 1)
    owner = np.column_stack([np.zeros_like(number), number])
    return Patches(points, start, owner, np.array([0, len(number)]))


def overlap_area(points, start, i, others, other_start, j):
    one, two = (
        CrossSection([p[s[k] : s[k + 1], :2].tolist()])
        for p, s, k in ((points, start, i), (others, other_start, j))
    )
    return (one ^ two).area()


@examples(30)
@given(st.integers(0, 10**6))
def test_patches_are_below_others_that_they_overlap_in_plan_and_reach_lower(seed):
    rng = np.random.default_rng(seed)
    held, surface = (of_one_column(*polygons(rng, 6), first) for first in (0, 100))
    found = np.zeros(6, np.bool_)
    find_below(held, surface, found)
    for s in range(6):
        lowest = surface.points[surface.start[s] : surface.start[s + 1], 2].min()
        areas = [
            overlap_area(held.points, held.start, h, surface.points, surface.start, s)
            for h in range(6)
            if lowest < held.points[held.start[h] : held.start[h + 1], 2].max()
        ]
        if max(areas, default=0.0) > LEAST_AREA:
            assert found[s]
        if max(areas, default=0.0) == 0.0:
            assert not found[s]


def test_a_patch_is_not_below_one_of_the_same_triangle():
    patches = of_one_column(*polygons(np.random.default_rng(1), 1), 0)
    raised = patches._replace(points=patches.points + (0.0, 0.0, 1.0))
    found = np.zeros(1, np.bool_)
    find_below(raised, patches, found)
    assert not found[0]


@examples(30)
@given(st.integers(0, 10**6))
def test_patches_of_one_colour_do_not_overlap(seed):
    points, start = polygons(np.random.default_rng(seed), 8)
    colour = np.empty(8, np.int64)
    colour_patches(points, start, 1e-4, colour)
    for i in range(8):
        for j in range(i):
            if colour[i] == colour[j]:
                assert overlap_area(points, start, i, points, start, j) < LEAST_AREA
    assert colour.min() == 0
    assert set(range(colour.max() + 1)) == set(colour.tolist()), "no colour is skipped"


def test_sides_conflict_unless_they_are_shared_whole_at_the_same_heights():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    neighbour = square + (1.0, 0.0, 0.0)
    for other, same in (
        (neighbour, True),
        (neighbour + (0.0, 0.5, 0.0), False),
        (neighbour + (0.0, 0.0, 0.2), False),
        (neighbour + (0.1, 0.0, 0.2), True),
    ):
        colour = np.empty(2, np.int64)
        colour_patches(np.concatenate([square, other]), np.array([0, 4, 8]), 1e-4, colour)
        assert (colour[0] == colour[1]) == same


def height_at(polygon, x, y):
    """Return the heights of a patch above points by its plane, infinity outside its projection."""
    x, y = np.asarray(x)[..., None], np.asarray(y)[..., None]
    edges = np.roll(polygon, -1, axis=0) - polygon
    sides = edges[:, 0] * (y - polygon[:, 1]) - edges[:, 1] * (x - polygon[:, 0])
    normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    fall = ((x - polygon[0, 0]) * normal[0] + (y - polygon[0, 1]) * normal[1])[..., 0] / normal[2]
    return np.where((sides < 0.0).any(axis=-1), np.inf, polygon[0, 2] - fall)


@examples(20)
@given(st.integers(0, 10**6))
def test_visible_patches_are_the_lowest_at_a_sample_point(seed):
    rng = np.random.default_rng(seed)
    points, start = polygons(rng, 6)
    rise, spacing = rng.uniform(-1, 1, 6), 0.1
    raised = RaisedPatches(points, start, rise)
    found = np.zeros(6, np.bool_)
    find_visible(raised, raised, spacing, found)
    each = [points[start[k] : start[k + 1]] for k in range(6)]
    nodes = np.arange(-20, 60) * spacing
    heights = np.array([height_at(polygon, *np.meshgrid(nodes, nodes)) for polygon in each])
    heights += rise[:, None, None]
    least = heights.min(axis=0)
    lowest = (np.isfinite(least) & (heights <= least)).any(axis=(1, 2))
    assert (found >= lowest).all(), "a patch that is the lowest at a lattice point is visible"
    for k in np.flatnonzero(found & ~lowest):
        middle = each[k][:, :2].mean(axis=0)
        samples = [middle, *(0.99 * each[k][:, :2] + 0.01 * middle)]
        seen = [[height_at(polygon, *sample) for polygon in each] + rise for sample in samples]
        assert any(heights[k] <= heights.min() + 1e-5 for heights in seen)
