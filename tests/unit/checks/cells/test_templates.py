"""The judge of templates and of the records of an answer."""

from dataclasses import replace

import numpy as np
import pytest

from amprep.checks.cells.templates import check_cells, check_template
from amprep.model import CellRequest, Cells, Grid, Mesh, SupportEdges, Template
from amprep.testing.problems import box_mesh

POST = box_mesh(np.array([0.25, 0.25, 0.0]), np.array([0.75, 0.75, 1.0]))
REQUEST = CellRequest(
    Grid(np.zeros(3), pitch=2.0, step=4.0, shape=(3, 3, 3)),
    SupportEdges([1, 2], [1, 1], [1, 1], [0, 1], [1, 1], [1, 1], group=[0, 0]),
    [1, 0],
)


@pytest.mark.parametrize(
    "mesh", [Mesh(POST.vertices, []), Mesh(POST.vertices, [[0, 1, 9]]), Mesh([[np.nan] * 3] * 3, [[0, 1, 2]])]
)
def test_a_template_without_sense_is_found_out(mesh):
    assert check_template(Template("x", mesh, surface=True))


def test_a_surface_need_not_be_closed():
    sheet = Mesh(POST.vertices, POST.triangles[:2])
    assert check_template(Template("sheet", sheet, surface=True)) == []
    assert check_template(Template("sheet", sheet))


def test_records_that_do_not_fit_the_request_are_found_out():
    template = Template("post", POST)
    right = Cells((template,), [0, 0], [0, 1], REQUEST.matrices)
    assert check_cells(REQUEST, right) == []
    for wrong in (
        replace(right, edge=[0, 2]),
        replace(right, template=[0, -1]),
        replace(right, edge=[0]),
        replace(right, matrix=np.full((2, 3, 4), np.nan)),
        replace(right, matrix=-REQUEST.matrices),
    ):
        assert {violation.promise for violation in check_cells(REQUEST, wrong)} == {"cell records"}


def test_a_request_has_one_role_for_each_edge():
    with pytest.raises(ValueError, match="one role for each of its 2 edges, got 1"):
        replace(REQUEST, role=[0])
