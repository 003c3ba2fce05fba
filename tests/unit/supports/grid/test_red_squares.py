"""States of voxels and red squares, compared with plain loops over every voxel and column."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.voxels.grid import Grid, VoxelBlock
from amprep.geometry.voxels.voxelise import UNMARKED
from amprep.model import BuildVolume, Voxel
from amprep.supports.grid.red_squares import PartVoxels, closed_voxels, find_red_squares, voxel_states

SHAPE = (7, 3, 4)
ROOM = BuildVolume([60, 60, 60])


def random_parts(seed, count):
    """Parts with random voxels and overhang regions, each in a block that leaves out the rim of the grid."""
    rng = np.random.default_rng(seed)
    grid = Grid(np.zeros(3), 1.0, 1.0, SHAPE)
    parts = []
    for _ in range(count):
        first = tuple(int(n) for n in rng.integers(0, 2, 3))
        block = VoxelBlock(grid, first, tuple(n - f for n, f in zip(SHAPE, first, strict=True)))
        occupied = rng.random(block.shape) < 0.4
        region = np.where(
            occupied & (rng.random(block.shape) < 0.7), rng.integers(0, 3, block.shape), UNMARKED
        )
        parts.append(PartVoxels(block, occupied, region.astype(np.int32), None))
    return grid, parts


def whole(part, values, empty):
    array = np.full(SHAPE, empty)
    array[part.block.slices] = values
    return array


@given(st.integers(0, 10**6), st.integers(1, 3))
@examples(60)
def test_red_squares_are_the_bottoms_of_runs_over_free_voxels_or_the_plate(seed, count):
    grid, parts = random_parts(seed, count)
    voxels, part_count = voxel_states(grid, ROOM, parts)
    total = sum(whole(part, part.occupied, empty=False).astype(int) for part in parts)
    assert (part_count == np.minimum(total, 2)).all()
    assert ((voxels == Voxel.OCCUPIED) == (total > 0)).all()
    expected = []
    for number, part in enumerate(parts):
        region = whole(part, part.region, UNMARKED)
        for k, y, x in np.ndindex(SHAPE):
            if region[k, y, x] == UNMARKED or (k and region[k - 1, y, x] != UNMARKED):
                continue
            if k and voxels[k - 1, y, x] != Voxel.FREE:
                continue
            top = k + 1
            while top < SHAPE[0] and region[top, y, x] != UNMARKED and total[top, y, x] < 2:
                top += 1
            expected.append((k, y, x, number, int(region[k:top, y, x].min()), top - k))
    red = find_red_squares(voxels, part_count, parts)
    found = np.column_stack([red.square, red.part, red.region, red.rise])
    assert [tuple(row) for row in found.tolist()] == expected


@pytest.mark.parametrize(
    "space",
    [
        BuildVolume([9.5, 10.0, 6.2]),
        BuildVolume([10.0, 10.0, 8.0], "cylinder"),
        BuildVolume([10.0, 10.0, 8.0], zone_lo=[[2.5, 3.0, 1.0]], zone_hi=[[4.0, 5.5, 3.5]]),
    ],
)
def test_a_voxel_is_closed_if_a_corner_is_outside_the_build_volume_or_it_meets_a_forbidden_zone(space):
    grid = Grid(np.zeros(3), 1.0, 1.0, (8, 10, 10))
    closed = closed_voxels(grid, space)
    for k, y, x in np.ndindex(grid.shape):
        corners = np.array([(x + i, y + j, k + h) for i in (0, 1) for j in (0, 1) for h in (0, 1)], float)
        outside = bool((corners > space.size + 1e-9).any())
        if space.shape == "cylinder":
            outside |= bool((np.hypot(*(corners[:, :2] - 5.0).T) > 5.0).any())
        for lo, hi in zip(space.zone_lo, space.zone_hi, strict=True):
            outside |= bool((corners.min(axis=0) < hi).all() and (corners.max(axis=0) > lo).all())
        assert closed[k, y, x] == outside, (k, y, x)
