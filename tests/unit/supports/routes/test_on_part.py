"""Columns on parts: straight down to the part's own voxels, through free voxels of no other part's supports."""

import numpy as np
import pytest

from amprep.geometry.voxels.grid import Grid, VoxelBlock
from amprep.model import SupportEdges, Voxel
from amprep.supports.grid.red_squares import PartVoxels, RedSquares, SupportGrid
from amprep.supports.routes.on_part import stand_on_parts

SHAPE = (10, 3, 4)
NONE = SupportEdges.from_rows([])


def laid(*occupied, part=0, closed=()):
    """A grid with one red square at (8, 1, 1) of part 0; `occupied` lists (part, (k, y, x))."""
    grid = Grid(np.zeros(3), 1.0, 1.0, SHAPE)
    block = VoxelBlock(grid, (0, 0, 0), SHAPE)
    own = np.zeros((2, *SHAPE), np.bool_)
    for number, voxel in ((part, (8, 1, 1)), *occupied):
        own[number][voxel] = True
    count = np.minimum(own.sum(axis=0), 2).astype(np.uint8)
    voxels = np.where(count > 0, np.uint8(Voxel.OCCUPIED), np.uint8(Voxel.FREE))
    for voxel in closed:
        voxels[voxel] = Voxel.CLOSED
    parts = tuple(PartVoxels(block, each, np.zeros(SHAPE, np.int32), None) for each in own)
    one = np.zeros(1, np.int32)
    return SupportGrid(grid, voxels, count, parts, RedSquares(np.array([[8, 1, 1]], np.int32), one, one, one))


def stand(*arguments, edges=NONE, **settings):
    return stand_on_parts(laid(*arguments, **settings), np.array([True]), edges)


@pytest.mark.parametrize(("below", "depth"), [(1, 1), (2, 2), (3, 2)])
def test_a_column_reaches_down_to_its_part_with_a_foot_of_at_most_two_voxels(below, depth):
    found = stand(*[(0, (4 - k, 1, 1)) for k in range(below)])
    assert found.connected.tolist() == [True]
    assert found.edges.upper.tolist() == [[p, 1, 1] for p in (6, 7, 8)]
    assert found.edges.lower.tolist() == [[p, 1, 1] for p in (5, 6, 7)]
    assert found.feet.tolist() == [[5, 1, 1, 0, depth]]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        [(1, (4, 1, 1))],
        [(0, (4, 1, 1)), (1, (4, 1, 1))],
        [(0, (7, 1, 1))],
    ],
    ids=["nothing below", "another part below", "two parts in the voxel", "no free voxel below"],
)
def test_no_column_stands_where_its_own_part_alone_does_not_bear_it(arguments):
    found = stand(*arguments)
    assert (found.connected.tolist(), len(found.edges), len(found.feet)) == ([False], 0, 0)


def test_closed_voxels_and_supports_of_other_parts_are_in_the_way_but_not_those_of_its_own():
    assert not stand((0, (3, 1, 1)), closed=[(5, 1, 1)]).connected.any()
    crossing = [[6, 1, 1, 0, 1, 1]]
    other, own = (SupportEdges.from_rows([[*row, part] for row in crossing]) for part in (1, 0))
    assert not stand((0, (3, 1, 1)), edges=other).connected.any()
    assert stand((0, (3, 1, 1)), edges=own).connected.all()
