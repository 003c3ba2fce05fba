"""Transforms of 3MF files are read and applied exactly."""

import re
import zipfile
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.checks.ordered.order import Order, check_order
from amprep.checks.printed.as_recorded import check_as_printed
from amprep.model import Mesh
from amprep.threemf import write_build
from amprep.threemf.build.read import read_build_file
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


def item_positions(path):
    """Return the translation of each build item as the file states it."""
    model = zipfile.ZipFile(path).read("3D/3dmodel.model").decode()
    items = re.findall(r"<item[^>]*transform=\"([^\"]*)\"", model)
    return np.array([[float(value) for value in item.split()[9:]] for item in items])


def test_objects_for_prusaslicer_count_from_the_origin_of_the_machine(make_build, tmp_path):
    build = make_build("prusaslicer", share=True)
    moved = replace(build, settings=replace(build.settings, plate_origin=(-107.0, -93.5)))
    for name, each in (("corner", build), ("middle", moved)):
        write_build(each, tmp_path / f"{name}.3mf")
    shift = item_positions(tmp_path / "middle.3mf") - item_positions(tmp_path / "corner.3mf")
    np.testing.assert_allclose(shift, np.tile([-107.0, -93.5, 0.0], (2, 1)), atol=1e-5)
    read = read_build_file(tmp_path / "middle.3mf")
    assert read.build.settings.plate_origin == (-107.0, -93.5)
    for found, expected in zip(read.build.parts, build.parts, strict=True):
        np.testing.assert_allclose(found.matrix, expected.matrix, atol=1e-5)
        assert found.moved_mm < 1e-4
    for body, planned in zip(read.build.supports, build.supports, strict=True):
        np.testing.assert_allclose(body.mesh.vertices, planned.mesh.vertices, atol=1e-5)
    assert check_as_printed(read.build, read.printed) == []


def test_a_file_for_another_origin_than_that_of_the_printer_is_not_as_ordered(make_build):
    build = make_build("prusaslicer")
    order = Order("BIBO", replace(build.settings, plate_origin=(-107.0, -93.0)))
    assert check_order(build, Order("BIBO", build.settings)) == []
    (found,) = check_order(build, order)
    assert found.message == "the corner of the plate is at (0, 0) mm, ordered (-107, -93) mm"
