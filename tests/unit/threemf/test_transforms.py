"""Transforms of 3MF files are read and applied exactly."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.model import Mesh
from amprep.threemf.transforms import column_matrix, inverse, round_as_stored, row_matrix, transform_exactly

FIELDS = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 10.0], [11.0, 12.0, 13.0]]
"""The rows of a 3MF transform: images of the three axes, then the translation."""


def test_the_fourth_row_of_a_3mf_transform_is_its_translation():
    transform = SimpleNamespace(Fields=FIELDS)
    moved = column_matrix(transform) @ [0.0, 0.0, 0.0, 1.0]
    assert moved.tolist() == [11.0, 12.0, 13.0, 1.0]
    assert (column_matrix(transform) @ [1.0, 0.0, 0.0, 0.0])[:3].tolist() == [1.0, 2.0, 3.0]


def test_row_and_column_matrices_are_transposes_of_each_other():
    transform = SimpleNamespace(Fields=FIELDS)
    np.testing.assert_array_equal(row_matrix(transform), column_matrix(transform).T)


def test_a_transform_and_its_inverse_cancel():
    matrix = column_matrix(SimpleNamespace(Fields=FIELDS))
    points = np.random.default_rng(3).normal(size=(50, 3))
    np.testing.assert_allclose(transform_exactly(transform_exactly(points, matrix), inverse(matrix)), points)


def test_transforming_exactly_agrees_with_the_matrix_product():
    matrix = column_matrix(SimpleNamespace(Fields=FIELDS))
    points = np.random.default_rng(4).normal(size=(50, 3))
    homogeneous = np.column_stack([points, np.ones(50)]) @ matrix.T
    np.testing.assert_allclose(transform_exactly(points, matrix), homogeneous[:, :3])


def test_a_singular_matrix_has_no_inverse():
    with pytest.raises(ValueError, match="Singular"):
        inverse(np.zeros((4, 4)))


@given(st.lists(st.floats(-1e4, 1e4, width=64), min_size=3, max_size=3))
def test_rounding_as_stored_keeps_the_digest_and_is_idempotent(point):
    mesh = Mesh(np.array([point]), np.empty((0, 3), np.int32))
    stored = round_as_stored(mesh.vertices)
    assert Mesh(stored, mesh.triangles).digest == mesh.digest
    np.testing.assert_array_equal(round_as_stored(stored), stored)
