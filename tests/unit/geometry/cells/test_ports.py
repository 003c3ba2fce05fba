"""Opposite sides of a cell get the same triangles, so that its copies weld."""

import numpy as np
import pytest
from tests.shared.cells import sheared, tiled

from amprep.geometry.cells.ports import conform
from amprep.geometry.meshes.manifold import as_manifold


def box(lo, hi):
    from amprep.testing.problems import box_mesh

    mesh = box_mesh(np.array(lo, np.float64), np.array(hi, np.float64))
    return mesh.vertices, mesh.triangles.astype(np.int64)


def test_sides_cut_along_different_diagonals_are_made_the_same():
    points, triangles = box((0, 0, 0), (1, 1, 1))
    twisted = triangles.copy()
    twisted[2:4] = [[4, 5, 6], [5, 7, 6]]  # the other diagonal on top
    assert len(tiled((points, twisted), sheared())) == 2
    assert len(tiled(conform(points, twisted), sheared())) == 1


def test_a_corner_on_one_side_alone_is_put_onto_the_other_too():
    points, triangles = box((0, 0.25, 0), (1, 0.75, 1))
    points = np.vstack([points, [0.5, 0.25, 1.0]])  # in the middle of the edge 4-5
    split = [[4, 8, 7], [8, 5, 7], [0, 5, 8], [0, 8, 4]]
    keep = [row for row in triangles.tolist() if not {4, 5} <= set(row)]
    mesh = np.array(keep + split)
    assert as_manifold(points, mesh).volume() == pytest.approx(0.5)
    assert len(tiled((points, mesh), sheared())) == 2
    conforming = conform(points, mesh)
    assert len(tiled(conforming, sheared())) == 1
    assert as_manifold(*conforming).volume() == pytest.approx(0.5)


def test_six_digits_are_enough_to_lie_on_a_side():
    points, triangles = box((0.25, 0.25, 0), (0.75, 0.75, 1))
    rough = points + 4e-6 * np.sin(np.arange(24).reshape(8, 3))
    tidy, _ = conform(rough, triangles)
    assert set(tidy[:, 2].tolist()) == {0.0, 1.0}
    assert tidy[tidy[:, 2] == 0.0][:, :2].tolist() == tidy[tidy[:, 2] == 1.0][:, :2].tolist()
