"""Volumes of bounding volumes equal those of solids that manifold3d unites, and of shapes known by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.builds import box_mesh
from tests.shared.examples import examples

from amprep.measures.bounding_volume import count_pieces, points_of, volume_of
from amprep.model import Boxes, ConvexPieces, Mesh, Solid
from amprep.model.mesh import join_meshes

CUBE = box_mesh((0, 0, 0), (10, 10, 10))
CROSSING = box_mesh((5, 0, 0), (10, 10, 10))
HOLLOW = join_meshes([CUBE, Mesh(box_mesh((2, 2, 2), (5, 5, 5)).vertices, CUBE.triangles[:, ::-1])])


@pytest.mark.parametrize(
    ("volume", "expected", "pieces"),
    [
        (Boxes([[0, 0, 0], [5, 0, 0]], [[10, 10, 10], [15, 10, 10]]), 1500.0, 2),
        (ConvexPieces((CUBE, CROSSING)), 1500.0, 2),
        (Solid(CUBE), 1000.0, 1),
        (Solid(join_meshes([CUBE, CROSSING])), 1500.0, 1),
        (Solid(HOLLOW), 875.0, 1),
    ],
    ids=["boxes", "pieces", "solid", "overlapping shells", "cavity"],
)
def test_overlaps_count_once_and_cavities_are_empty(volume, expected, pieces):
    assert volume_of(volume) == pytest.approx(expected)
    assert count_pieces(volume) == pieces


corners = st.lists(st.tuples(*[st.floats(-9, 9)] * 3, *[st.floats(0.1, 9)] * 3), min_size=1, max_size=5)


@given(corners)
@examples(30)
def test_boxes_as_boxes_and_as_pieces_have_the_same_volume_and_the_same_points(rows):
    lo, size = np.split(np.array(rows), 2, axis=1)
    boxes = Boxes(lo, lo + size)
    pieces = ConvexPieces(tuple(box_mesh(tuple(a), tuple(b)) for a, b in zip(lo, size, strict=True)))
    assert volume_of(boxes) == pytest.approx(volume_of(pieces), rel=1e-5)
    for points in (points_of(boxes), points_of(pieces)):
        assert points.min(axis=0) == pytest.approx(boxes.enclosing()[0], abs=1e-5)
        assert points.max(axis=0) == pytest.approx(boxes.enclosing()[1], abs=1e-5)
