"""A cell from a mesh file, and the judge of templates."""

from dataclasses import replace

import numpy as np
import pytest

from amprep.checks.templates import check_cells, check_template
from amprep.errors import JobError, MeshError
from amprep.host import Host
from amprep.job import apply_sets, job_from_inputs
from amprep.model import CellRequest, Cells, GridFrame, Mesh, Stop, Template, silent
from amprep.pipeline.cell_file import choose_cell
from amprep.pipeline.trial_problems import box_mesh

POST = box_mesh(np.array([0.25, 0.25, 0.0]), np.array([0.75, 0.75, 1.0]))
FRAME = GridFrame(np.zeros(3), pitch=2.0, step=4.0, shape=(3, 3, 3))
REQUEST = CellRequest(FRAME, [1, 2], [1, 1], [1, 1], [0, 1], [1, 0], [1, 1], [0, 0])


@pytest.fixture(scope="module")
def host():
    return Host.load(plugins_enabled=False)


def job_with(cell):
    return apply_sets(job_from_inputs(["part.stl"]), [f"cells.strategy={str(cell)!r}"])


def saved(mesh, path):
    import trimesh

    trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False).export(path)
    return path


def test_a_name_chooses_the_cell_of_a_plugin(host):
    assert choose_cell(host, job_with("prism")) is host.choose("cell", "prism")


def test_a_mesh_file_is_repeated_under_the_map_of_every_edge(host, tmp_path):
    listed = choose_cell(host, job_with(saved(POST, tmp_path / "post.stl")))
    params = host.params(listed, {})
    cells = host.call(listed, REQUEST, params=params, stop=Stop(), report=silent)
    assert check_cells(REQUEST, cells) == []
    assert (cells.edge.tolist(), listed.offer.name) == ([0, 1], "post")
    # a quarter of the square: 0.25 * 2 * 2 * 4
    assert host.material(listed, 2.0, 4.0, params) == pytest.approx((4.0, 4.0))
    with pytest.raises(JobError, match="unknown key 'size'"):
        host.params(listed, {"size": 3})


@pytest.mark.parametrize(
    ("mesh", "reason"),
    [
        (POST.moved(np.diag([10.0, 10, 10, 1])), "leaves the unit cube by 9"),
        (Mesh(POST.vertices, POST.triangles[1:]), "as often in both directions"),
        (Mesh(POST.vertices, POST.triangles[:, ::-1]), "expected a positive volume, got -0.25"),
    ],
)
def test_a_file_that_holds_no_cell_is_refused_by_name_and_reason(host, tmp_path, mesh, reason):
    path = saved(mesh, tmp_path / "wrong.stl")
    with pytest.raises(
        MeshError, match=f"wrong.stl: a cell is a closed mesh in the unit cube, z up; .*{reason}"
    ):
        choose_cell(host, job_with(path))


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
