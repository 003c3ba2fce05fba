"""Voxels are closed exactly where the supports of another layout are."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.layouts import box, layout, placed

from amprep.geometry.voxels.grid import Grid
from amprep.model.supports import Voxel
from amprep.supports.grid.taken import close_taken, taken_by

TABLE = placed(box([4, 12, 12], [20, 20, 0]) + box([14, 12, 3], [20, 20, 9]))


@given(pitch=st.floats(0.6, 2.5), shift=st.floats(-0.5, 0.5))
@examples(15)
def test_a_voxel_is_closed_if_and_only_if_it_meets_a_used_voxel(pitch, shift):
    earlier = layout(TABLE, pitch_mm=1.3)
    taken = taken_by([earlier])
    grid = Grid(np.array([10.0 + shift, 10.0, 0.0]), pitch, pitch, (int(15 / pitch), 16, 16))
    voxels = np.full(grid.shape, Voxel.FREE, np.uint8)
    close_taken(voxels, grid, taken)
    centres = np.argwhere(np.ones(grid.shape))[:, ::-1] * grid.size + grid.origin + grid.size / 2
    depth = np.full(len(centres), -np.inf)
    for lo, hi in zip(taken.lo, taken.hi, strict=True):
        apart = np.maximum(lo - centres, centres - hi).max(axis=1)
        depth = np.maximum(depth, grid.pitch / 2 - apart)
    clear = np.abs(depth) > 1e-6  # not just touching
    assert ((voxels.ravel() == Voxel.CLOSED) == (depth > 0))[clear].all()


def test_the_supports_of_a_layout_are_inside_the_boxes():
    earlier = layout(TABLE)
    taken = taken_by([earlier])
    middle = (earlier.edges.upper + earlier.edges.lower)[:, ::-1] / 2 * earlier.grid.size
    middle = middle + earlier.grid.origin + earlier.grid.size * (0.5, 0.5, 0.0)
    inside = ((middle[:, None] >= taken.lo - 1e-9) & (middle[:, None] <= taken.hi + 1e-9)).all(axis=2)
    assert inside.any(axis=1).all()


def test_occupied_voxels_stay_occupied():
    earlier = layout(TABLE)
    voxels = earlier.voxels.copy()
    close_taken(voxels, earlier.grid, taken_by([earlier]))
    assert ((voxels == Voxel.OCCUPIED) == (earlier.voxels == Voxel.OCCUPIED)).all()
    assert (voxels[tuple(earlier.edges.voxels.T)] != Voxel.FREE).all()
