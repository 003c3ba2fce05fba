from functools import cache
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.shared.examples import examples

from amprep.geometry.bounding.boxes.branch_and_cut import cover_cells
from amprep.geometry.bounding.boxes.cells import required_cells


@cache
def unions_of(shape, count):
    """Every union of at most `count` blocks of cells of a grid, each as a number whose bits are the cells in it."""
    bits = 1 << np.arange(np.prod(shape)).reshape(shape)
    spans = [[slice(a, b) for a in range(n) for b in range(a + 1, n + 1)] for n in shape]
    blocks = np.array([bits[block].sum() for block in product(*spans)])
    unions = np.zeros(1, np.int64)
    for _ in range(count):
        unions = np.unique(unions[:, None] | blocks)
    return unions


def number_of(cells):
    return int((1 << np.flatnonzero(cells)).sum())


def coverings(cells, count):
    """Unions of `count` blocks that contain the cells, by brute force."""
    unions = unions_of(cells.shape, count)
    return unions[unions & number_of(cells) == number_of(cells)]


def least(cells, count):
    return min(union.bit_count() for union in coverings(cells, count).tolist())


def cells_in(shape):
    return arrays(bool, shape).filter(np.any)


@pytest.mark.parametrize(("shape", "count"), [((4, 3, 2), 2), ((3, 2, 2), 3), ((4, 3, 1), 3), ((3, 3, 1), 4)])
@given(data=st.data())
@examples(25)
def test_a_complete_search_finds_the_least_covering_and_proves_it(shape, count, data):
    cells = data.draw(cells_in(shape))
    found = cover_cells(cells, count, limit=cells.size + 1, work=1e9, stop=lambda: False)
    assert found.cells == found.bound == least(cells, count)
    covered = np.zeros(shape, bool)
    for x0, y0, z0, x1, y1, z1 in found.blocks.tolist():
        covered[x0:x1, y0:y1, z0:z1] = True
    assert (covered >= cells).all()
    assert covered.sum() == found.cells
    assert len(found.blocks) <= count


@given(cells=cells_in((4, 3, 1)), work=st.integers(0, 300), steps=st.integers(0, 3))
@examples(50)
def test_the_bound_of_a_search_that_ends_early_is_a_bound(cells, work, steps):
    questions = iter([False] * steps)
    found = cover_cells(cells, 3, limit=cells.size + 1, work=work / 1e6, stop=lambda: next(questions, True))
    best = least(cells, 3)
    assert found.bound <= best
    assert found.cells >= best


def test_nothing_is_found_below_the_least_covering():
    cells = np.ones((3, 3, 3), bool)
    cells[1, 1, :] = cells[0, 0, 0] = False
    found = cover_cells(cells, 3, limit=26, work=1e9, stop=lambda: False)
    assert (len(found.blocks), found.cells, found.bound) == (0, 26, 26)


@pytest.mark.parametrize("count", [2, 3])
@given(cells=cells_in((3, 3, 2)))
@examples(30)
def test_required_cells_are_in_every_covering(cells, count):
    required = required_cells(cells, count)
    assert (required >= cells).all()
    assert (coverings(cells, count) & number_of(required) == number_of(required)).all()


def test_the_inside_of_a_cup_is_required_of_four_boxes_but_not_of_five():
    cup = np.ones((5, 5, 5), bool)
    cup[1:4, 1:4, 1:] = False
    assert required_cells(cup, 4).all()
    assert required_cells(cup, 5).sum() == cup.sum()
