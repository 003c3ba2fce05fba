"""Triangles clipped to columns: areas as by manifold3d, heights in their planes, nothing lost between columns."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection
from tests.shared.examples import examples

from amprep.kernels.meshes.clip_columns import ColumnIndex, PatchBuffers, clip_to_columns

NY, NX, PITCH = 3, 4, 1.5


def all_columns(bottom, top):
    y, x = np.divmod(np.arange(NY * NX), NX)
    lo = np.column_stack([x * PITCH, y * PITCH, np.full(len(x), bottom)])
    hi = np.column_stack([(x + 1) * PITCH, (y + 1) * PITCH, np.full(len(x), top)])
    grid = np.array([0.0, 0.0, PITCH])
    return ColumnIndex(grid, (NY, NX), np.arange(NY * NX + 1), np.arange(NY * NX), lo, hi)


def buffers(room):
    return PatchBuffers(np.empty((8 * room, 3)), np.empty(room + 1, np.int64), np.empty((room, 2), np.int64))


def downward(rng, count):
    """Return random triangles ``(n, 3, 3)`` that face down."""
    corners = rng.uniform((-1, -1, 0), (7, 6, 5), (count, 3, 3))
    sides = corners[:, 1:] - corners[:, :1]
    up = np.cross(sides[:, 0], sides[:, 1])[:, 2] > 0
    corners[up] = corners[up][:, ::-1]
    return corners


def area_of(points):
    following = np.roll(points, -1, axis=0)
    return 0.5 * float((points[:, 0] * following[:, 1] - points[:, 1] * following[:, 0]).sum())


@examples(30)
@given(st.integers(0, 10**6))
def test_the_patches_in_a_column_have_the_area_of_triangle_and_square_in_common(seed):
    corners, index, out = downward(np.random.default_rng(seed), 5), all_columns(-1.0, 6.0), buffers(200)
    count = clip_to_columns(corners, index, 1e-6, out)
    found = np.zeros((NY * NX, 5))
    for k in range(count):
        points = out.points[out.start[k] : out.start[k + 1]]
        column, triangle = out.owner[k]
        found[column, triangle] += area_of(points)
        normal = np.cross(
            corners[triangle, 1] - corners[triangle, 0], corners[triangle, 2] - corners[triangle, 0]
        )
        heights = (points - corners[triangle, 0]) @ normal / np.linalg.norm(normal)
        assert np.abs(heights).max() < 1e-9, "patches are in the planes of their triangles"
    for column in range(NY * NX):
        square = CrossSection.square((PITCH, PITCH)).translate(index.lo[column, :2].tolist())
        for triangle in range(5):
            shape = CrossSection([corners[triangle, ::-1, :2].tolist()])
            assert found[column, triangle] == pytest.approx((shape ^ square).area(), abs=1e-5)


def test_triangles_that_face_up_or_stand_upright_are_skipped():
    corners = downward(np.random.default_rng(3), 4)
    upright = np.array([[[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.5, 1.0, 2.0]]])
    assert clip_to_columns(corners[:, ::-1].copy(), all_columns(0.0, 5.0), 1e-6, buffers(200)) == 0
    assert clip_to_columns(upright, all_columns(0.0, 5.0), 1e-6, buffers(200)) == 0


def test_bottom_and_top_clip_too():
    corners = np.array([[[0.0, 0.0, 0.0], [0.0, 4.0, 0.0], [5.0, 0.0, 5.0]]])
    out = buffers(100)
    count = clip_to_columns(corners, all_columns(1.0, 2.0), 0.0, out)
    assert count > 0
    heights = out.points[: out.start[count], 2]
    assert (heights.min(), heights.max()) == (1.0, 2.0)


def test_arrays_that_are_too_short_are_reported():
    corners = downward(np.random.default_rng(5), 5)
    assert clip_to_columns(corners, all_columns(-1.0, 6.0), 1e-6, buffers(2)) == -1
