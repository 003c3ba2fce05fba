"""The lowest free cell against brute force over boxes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.no_fit import box_shapes, boxes_overlap, in_box, layout_of

from amprep.kernels.no_fit.records import ShapeLayout
from amprep.kernels.no_fit.scan import lowest_free


def ones(items):
    return np.broadcast_to(1.0, (items, items))


def lowest_by_force(sizes, layout, grid, step, within):
    """The first cell in the order of height, then of x + y, at which the last item overlaps nothing."""
    last = len(layout.shape) - 1
    cells = sorted(np.ndindex(*grid), key=lambda c: (c[2], c[0] + c[1]))
    for cell in cells:
        at = within.lo[layout.shape[last]] + 2.0 * step * np.array(cell)
        layout.position[last] = at
        if not any(boxes_overlap(sizes, layout, last, other) for other in range(last)):
            return cell
    return None


@examples(40)
@given(st.data())
def test_the_lowest_free_cell_is_found(data):
    step = 0.5
    sizes = [[data.draw(st.integers(1, 4)) for _ in range(3)] for _ in range(3)]
    shapes = [data.draw(st.integers(0, 2)) for _ in range(data.draw(st.integers(1, 5)))]
    _, fields = box_shapes(sizes, step)
    within = in_box(sizes, (6.0, 6.0, 8.0))
    positions = [[data.draw(st.integers(0, 4)) for _ in range(3)] for _ in shapes]
    layout = layout_of(shapes, positions)
    grid = ((within.hi[shapes[-1]] - within.lo[shapes[-1]]) / (2.0 * step)).astype(np.int64) + 1
    expected = lowest_by_force(sizes, layout, grid.tolist(), step, within)
    k = len(shapes) - 1
    read = lowest_free(
        fields, within, layout, ones(k + 1), k, 0, grid, np.empty(int(grid.prod()), np.float32)
    )
    if expected is None:
        assert read < 0
    else:
        found = np.round(layout.position[k] - within.lo[shapes[k]], 6)
        assert (found[2], found[0] + found[1]) == (expected[2], expected[0] + expected[1])


@examples(30)
@given(st.data())
def test_sums_that_are_continued_give_the_position_of_a_fresh_scan(data):
    """Identical items are placed one after another; each scan adds the items that are new."""
    step, k = 0.5, data.draw(st.integers(1, 4))
    sizes = [[data.draw(st.integers(1, 3)) for _ in range(3)] for _ in range(2)]
    _, fields = box_shapes(sizes, step)
    within = in_box(sizes, (6.0, 6.0, 8.0))
    layout = layout_of([0] * k + [1] * 4, np.zeros((k + 4, 3)))
    layout.position[:k] = [[data.draw(st.integers(0, 3)) for _ in range(3)] for _ in range(k)]
    layout.build[k:] = -2
    grid = ((within.hi[1] - within.lo[1]) / (2.0 * step)).astype(np.int64) + 1
    sums, since = np.empty(int(grid.prod()), np.float32), 0
    for row in range(k, k + 4):
        layout.build[row] = 0
        read = lowest_free(fields, within, layout, ones(k + 4), row, since, grid, sums)
        fresh = ShapeLayout(layout.shape, layout.build, layout.position.copy())
        again = lowest_free(fields, within, fresh, ones(k + 4), row, 0, grid, np.empty_like(sums))
        assert (read > 0) == (again > 0)
        np.testing.assert_allclose(layout.position[row], fresh.position[row], atol=1e-9)
        if read < 0:
            break
        since = row


def test_an_item_moves_on_by_single_steps_from_the_cell_found():
    _, fields = box_shapes([[3, 3, 3], [2, 2, 2]], 0.5)
    within = in_box([[3, 3, 3], [2, 2, 2]], (3.0, 3.0, 9.0))
    layout = layout_of([0, 1], [[0, 0, 0.5], [0, 0, 0]])
    layout.position[0, 2] = -0.5
    read = lowest_free(fields, within, layout, ones(2), 1, 0, np.array([2, 2, 8]), np.empty(32, np.float32))
    assert read > 0
    assert layout.position[1].tolist() == [0.0, 0.0, 2.5]


@pytest.mark.parametrize(("radius", "expected"), [(5.0, True), (2.0, False)])
def test_a_cell_outside_the_circle_is_not_free(radius, expected):
    _, fields = box_shapes([[3, 3, 1]], 0.5)
    outline = np.array([[0.0, 0], [3, 0], [3, 3], [0, 3]])
    within = in_box([[3, 3, 1]], (6.0, 6.0, 1.0))
    within = within._replace(
        radius=radius, centre=np.array([3.0, 3.0]), outline=outline, first=np.array([0, 4])
    )
    layout = layout_of([0], [[0, 0, 0]])
    grid = np.array([4, 4, 1])
    read = lowest_free(fields, within, layout, ones(1), 0, 0, grid, np.empty(16, np.float32))
    assert (read > 0) == expected
    if expected:
        corners = outline + layout.position[0, :2]
        assert np.hypot(*(corners - 3.0).T).max() <= radius
