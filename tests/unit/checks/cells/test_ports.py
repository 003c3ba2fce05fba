"""The judge of ports finds cells beside and above each other whose sections differ or do not touch."""

import numpy as np
import pytest
from tests.shared.cells import FRAME

from amprep.checks.cells.ports import check_ports, port_areas
from amprep.model import CellRequest, Cells, Mesh, SupportEdges, Template
from amprep.testing.problems import box_mesh

# two columns side by side, two cells high: lower and upper left, lower and upper right
PLANE, X = np.array([1, 2, 1, 2]), np.array([1, 1, 2, 2])
REQUEST = CellRequest(
    FRAME, SupportEdges(*np.broadcast_arrays(PLANE, 1, X, 0, 1, 1, 0, 0)), np.zeros(4, np.int32)
)


def block(low, high):
    return Template("block", box_mesh(np.array(low, float), np.array(high, float)))


def wall(x):
    """Return a sheet across the cube at the given x."""
    corners = [[x, 0, 0], [x, 1, 0], [x, 1, 1], [x, 0, 1]]
    return Template("wall", Mesh(np.array(corners, float), [[0, 1, 2], [0, 2, 3]]), surface=True)


def slope(low, high):
    """Return a sheet across the cube that rises from one x to another."""
    corners = [[low, 0, 0], [low, 1, 0], [high, 1, 1], [high, 0, 1]]
    return Template("slope", Mesh(np.array(corners, float), [[0, 1, 2], [0, 2, 3]]), surface=True)


def faults(templates, chosen=(0, 0, 0, 0)):
    cells = Cells(tuple(templates), np.array(chosen), np.arange(4), REQUEST.matrices)
    return [violation.message for violation in check_ports(REQUEST, cells)]


FULL, POST = block((0, 0, 0), (1, 1, 1)), block((0.25, 0.25, 0), (0.75, 0.75, 1))


def test_areas_are_those_of_the_parts_of_a_template_in_the_sides():
    assert port_areas(FULL) == pytest.approx(np.ones(6))
    assert port_areas(POST) == pytest.approx([0, 0, 0, 0, 0.25, 0.25])


@pytest.mark.parametrize("template", [FULL, POST, wall(0.5)])
def test_a_cell_that_continues_in_its_neighbours_has_no_fault(template):
    assert faults([template]) == []


def test_cells_side_by_side_must_have_equal_sections_unless_one_does_not_reach_the_side():
    half = block((0, 0, 0), (1, 1, 0.5))
    (fault,) = faults([FULL, half], (0, 0, 1, 0))[:1]
    assert (
        "its right side covers 100.00% of the square, the left side of the adjacent block covers 50.00%"
        in fault
    )
    assert faults([FULL, POST], (0, 0, 1, 1)) == []


def test_a_cell_must_stand_on_the_one_below():
    corner = block((0.8, 0.8, 0), (1, 1, 1))
    assert any("does not stand on" in fault for fault in faults([POST, corner], (0, 1, 0, 1)))
    assert faults([FULL, POST], (0, 1, 0, 1)) == []
    hanging = block((0.2, 0.2, 0.3), (0.8, 0.8, 1))
    assert any("does not stand on" in fault for fault in faults([FULL, hanging], (0, 1, 0, 1)))


def test_sheets_must_share_a_corner_with_the_sheet_below():
    assert faults([wall(0.5), slope(0.5, 0.25)], (0, 1, 0, 1)) == []
    (fault,) = faults([wall(0.5), slope(0.25, 0.5)], (0, 1, 0, 1))
    assert fault == "its edges on the top side are not those of slope"
    assert any("top side" in fault for fault in faults([slope(0.25, 0.75)])), "the same sheet above itself"
    assert faults([wall(0.5), POST], (0, 1, 0, 1)) == [], "a sheet and a solid are not compared"
