"""Cells are the connected components of a solid with their hulls."""

import pytest
from tests.shared.convex_solids import SOLIDS, part_of

from amprep.geometry.bounding.convex.cells import cells_of, edges_of, hull_corners


def test_components_are_cells_and_cavities_are_filled():
    assert len(cells_of(SOLIDS["apart"]())) == 2
    (hollow,) = cells_of(SOLIDS["hollow"]())
    assert hollow.solid.volume() == pytest.approx(8000.0)
    assert hollow.excess == pytest.approx(0.0, abs=1e-3)


def test_the_excess_of_an_angle_is_the_volume_between_it_and_its_hull():
    (cell,) = cells_of(SOLIDS["angle"]())
    assert cell.excess == pytest.approx(15 * 15 / 2 * 10)
    assert len(cell.corners) == 10


def test_each_edge_of_a_closed_mesh_is_listed_once():
    _, triangles = part_of(SOLIDS["ring"]()).mesh.arrays
    edges = edges_of(triangles)
    assert len(edges) == 3 * len(triangles) // 2
    assert len({tuple(edge) for edge in edges.tolist()}) == len(edges)
    assert (edges[:, 0] < edges[:, 1]).all()


def test_corners_of_a_hull_leave_out_inner_points():
    (cell,) = cells_of(SOLIDS["tee"]())
    assert len(hull_corners(cell.vertices)) < len(cell.vertices)
