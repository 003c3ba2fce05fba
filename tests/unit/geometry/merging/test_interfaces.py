"""Interfaces between two outlines, against polygon clipping and against the outlines themselves."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.geometry.merging.interfaces import make_interface
from amprep.geometry.merging.voxel_contents import RESOLUTION


def outline(*corners):
    points = (np.array(corners) * RESOLUTION).round().astype(np.int64)
    return np.stack([points, np.roll(points, -1, axis=0)], axis=1)


def area(points, triangles):
    corners = points[triangles] / RESOLUTION
    sides = corners[:, 1:] - corners[:, :1]
    return float(np.linalg.det(sides).sum() / 2)


def test_equal_regions_leave_nothing_of_one_another():
    square = outline((0, 0), (1, 0), (1, 1), (0, 1))
    found = make_interface(square, square)
    assert found is not None
    assert len(found.low) == len(found.high) == len(found.splits) == 0


def test_a_corner_on_the_other_s_edge_splits_it():
    found = make_interface(
        outline((0, 0), (1, 0), (1, 1), (0, 1)), outline((0, 0), (0.5, 0), (1, 0), (1, 1), (0, 1))
    )
    assert found is not None
    assert len(found.low) == len(found.high) == 0
    assert (found.points[found.splits[:, 2]] == [[RESOLUTION // 2, 0]]).all()


RADII = st.lists(st.floats(0.05, 0.45), min_size=3, max_size=9)
TURNS = st.floats(
    0.01, 1.0
)  # outlines that almost coincide may have no interface; then the solids are united


def star(radii, turn):
    """A polygon around the middle of the unit square with corners at these distances."""
    angle = turn + 2 * np.pi * np.arange(len(radii)) / len(radii)
    return outline(*(0.5 + np.array(radii)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])))


@given(RADII, RADII, TURNS)
@examples(40)
def test_what_is_left_of_two_regions_has_the_area_that_clipping_gives(ours, theirs, turn):
    from manifold3d import CrossSection, FillRule

    first, second = star(ours, 0.0), star(theirs, turn)
    found = make_interface(first, second)
    assert found is not None
    a, b = (CrossSection([each[:, 0] / RESOLUTION], FillRule.Positive) for each in (first, second))
    assert area(found.points, found.low) == pytest.approx((a - b).area(), abs=1e-5)
    assert area(found.points, found.high) == pytest.approx((b - a).area(), abs=1e-5)


def net_edges(edges, middle=None):
    """Count directed edges, forward ones less backward ones, after all splits."""
    net: Counter[tuple[int, int]] = Counter()
    todo = [tuple(edge) for edge in edges]
    while todo:
        a, b = todo.pop()
        point = (middle or {}).get((min(a, b), max(a, b)))
        if point is not None:
            todo += [(a, point), (point, b)]
        else:
            net[min(a, b), max(a, b)] += 1 if a < b else -1
    return {key: count for key, count in net.items() if count}


@given(RADII, RADII, TURNS)
def test_exposed_parts_have_the_edges_of_the_outlines_after_their_splits(radii, others, turn):
    """The boundary of low - high, less that of high - low, is the outline of low less that of high."""
    low, high = star(radii, 0.0), star(others, turn)
    found = present(make_interface(low, high))
    number = {tuple(point): index for index, point in enumerate(found.points.tolist())}
    middle = {(min(a, b), max(a, b)): c for a, b, c in found.splits.tolist()}
    outlines = [[number[tuple(a)], number[tuple(b)]] for a, b in low.tolist()]
    outlines += [[number[tuple(b)], number[tuple(a)]] for a, b in high.tolist()]
    exposed = np.concatenate([found.low, found.high[:, ::-1]])
    boundary = np.concatenate([exposed[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]).tolist()
    assert net_edges(boundary) == net_edges(outlines, middle)


def test_regions_apart_are_exposed_as_they_are():
    low, high = outline((0, 0), (0.4, 0), (0.4, 1), (0, 1)), outline((0.6, 0), (1, 0), (1, 1), (0.6, 1))
    found = present(make_interface(low, high))
    assert (area(found.points, found.low), area(found.points, found.high)) == pytest.approx((0.4, 0.4))
    assert len(found.splits) == 0


def test_a_region_inside_another_leaves_a_ring_and_nothing():
    around = outline((0, 0), (1, 0), (1, 1), (0, 1))
    inside = outline((0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.2, 0.8))
    found = present(make_interface(around, inside))
    assert area(found.points, found.low) == pytest.approx(1 - 0.36)
    assert len(found.high) == 0
