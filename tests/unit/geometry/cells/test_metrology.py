"""Smallest features, gaps and closed pockets are measured to within a voxel."""

import numpy as np
import pytest

from amprep.geometry.cells.metrology import escape_diameter, smallest_feature
from amprep.model import Mesh
from amprep.testing.problems import box_mesh


def box(lo, hi):
    return box_mesh(np.array(lo, np.float64), np.array(hi, np.float64))


def both(one, other):
    triangles = np.vstack([one.triangles, other.triangles + len(one.vertices)])
    return Mesh(np.vstack([one.vertices, other.vertices]), triangles)


def hollow(lo, hi):
    inner = box(lo, hi)
    return both(box((0, 0, 0), (1, 1, 1)), Mesh(inner.vertices, inner.triangles[:, ::-1]))


def test_a_closed_pocket_is_measured():
    mesh = hollow((0.25, 0.25, 0.25), (0.75, 0.75, 0.75))
    place = np.array([[x, y, 0] for x in range(3) for y in range(3)])
    arrays = [(mesh.vertices, mesh.triangles.astype(np.int64))]
    _, pocket = escape_diameter(arrays, np.zeros(9, np.int64), place, np.full(3, 2.0), 16)
    assert pocket == pytest.approx(0.125)


@pytest.mark.parametrize("width", [0.2, 0.3, 0.5])
def test_walls_and_gaps_are_measured_to_within_a_voxel(width):
    mesh = box((0.5 - width / 2, 0, 0), (0.5 + width / 2, 1, 1))
    place = np.array([[x, y, z] for x in range(3) for y in range(3) for z in range(2)])
    arrays = (
        [(mesh.vertices, mesh.triangles.astype(np.int64))],
        np.zeros(18, np.int64),
        place,
        np.full(3, 2.0),
    )
    assert smallest_feature(*arrays, 24) == pytest.approx(2 * width, abs=2 / 24 * 1.5)
    assert escape_diameter(*arrays, 24)[0] == pytest.approx(2 - 2 * width, abs=2 / 24 * 1.5)
