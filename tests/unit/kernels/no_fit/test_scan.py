"""The lowest free cell against brute force over boxes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.no_fit import box_shapes, boxes_overlap, in_box, layout_of

from amprep.kernels.no_fit.scan import lowest_free


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
    weight = np.ones((len(shapes), len(shapes)))
    cell = lowest_free(
        fields, within, layout, weight, len(shapes) - 1, grid, 1e-4, np.empty(int(grid.prod()), np.float32)
    )
    expected = lowest_by_force(sizes, layout, grid.tolist(), step, within)
    if expected is None:
        assert cell == -1
    else:
        found = np.unravel_index(cell, grid)
        assert (found[2], found[0] + found[1]) == (expected[2], expected[0] + expected[1])


@pytest.mark.parametrize(("radius", "expected"), [(5.0, True), (2.0, False)])
def test_a_cell_outside_the_circle_is_not_free(radius, expected):
    _, fields = box_shapes([[3, 3, 1]], 0.5)
    outline = np.array([[0.0, 0], [3, 0], [3, 3], [0, 3]])
    within = in_box([[3, 3, 1]], (6.0, 6.0, 1.0))
    within = within._replace(
        radius=radius, centre=np.array([3.0, 3.0]), outline=outline, first=np.array([0, 4])
    )
    layout = layout_of([0], [[0, 0, 0]])
    cell = lowest_free(
        fields, within, layout, np.ones((1, 1)), 0, np.array([4, 4, 1]), 1e-4, np.empty(16, np.float32)
    )
    assert (cell >= 0) == expected
    if expected:
        corners = outline + np.array(np.unravel_index(cell, (4, 4, 1)))[:2]
        assert np.hypot(*(corners - 3.0).T).max() <= radius
