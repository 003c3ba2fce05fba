"""Resolve the lattice cell and the packer that a job names."""

import numpy as np
import pytest

from amprep.checks.cells.templates import check_cells
from amprep.errors import JobError, MeshError, PluginError
from amprep.host import Host
from amprep.job import PackingSettings, apply_sets, job_from_inputs, override
from amprep.model import CellRequest, Grid, Mesh, SupportEdges
from amprep.pipeline.resolve import cell_named, choose_cell, choose_packer, resolve
from amprep.testing.problems import box_mesh

POST = box_mesh(np.array([0.25, 0.25, 0.0]), np.array([0.75, 0.75, 1.0]))
FRAME = Grid(np.zeros(3), pitch=2.0, step=4.0, shape=(3, 3, 3))
LEVELS = ("fast", "normal", "thorough")
REQUEST = CellRequest(
    FRAME, SupportEdges([1, 2], [1, 1], [1, 1], [0, 1], [1, 1], [1, 1], group=[0, 0]), [1, 0]
)


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
    assert choose_cell(host, job_with("prism")).listed is host.choose("cell", "prism")


def test_a_mesh_file_is_repeated_under_the_map_of_every_edge(host, tmp_path):
    cell = choose_cell(host, job_with(saved(POST, tmp_path / "post.stl")))
    cells = cell.emit(REQUEST)
    assert check_cells(REQUEST, cells) == []
    assert (cells.edge.tolist(), cell.name) == ([0, 1], "post")
    # a quarter of the square: 0.25 * 2 * 2 * 4
    assert cell.material(2.0, 4.0) == pytest.approx((4.0, 4.0))
    with pytest.raises(JobError, match="unknown key 'size'"):
        cell_named(host, str(tmp_path / "post.stl"), ["size=3"])


@pytest.mark.parametrize(
    ("mesh", "reason"),
    [
        (POST.moved(np.diag([10.0, 10, 10, 1])), "extends beyond the unit cube by 9"),
        (Mesh(POST.vertices, POST.triangles[1:]), "equally often in both directions"),
        (Mesh(POST.vertices, POST.triangles[:, ::-1]), "expected a positive volume, got -0.25"),
    ],
)
def test_a_file_that_holds_no_cell_is_refused_by_name_and_reason(host, tmp_path, mesh, reason):
    path = saved(mesh, tmp_path / "wrong.stl")
    with pytest.raises(
        MeshError, match=f"wrong.stl: a cell must be a closed mesh in the unit cube, z up; .*{reason}"
    ):
        choose_cell(host, job_with(path))


def openscad_stl(mesh):
    """The text OpenSCAD saves: ASCII, six digits, a normal for each facet."""
    lines = ["solid OpenSCAD_Model"]
    for corners in mesh.vertices[mesh.triangles]:
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        lines.append("  facet normal {:g} {:g} {:g}".format(*normal / np.linalg.norm(normal)))
        lines += ["    outer loop"] + ["      vertex {:g} {:g} {:g}".format(*corner) for corner in corners]
        lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, "endsolid OpenSCAD_Model", ""])


def hexagon_column():
    """`translate([.5, .5, 0]) cylinder(d = 0.7, h = 1, $fn = 6)` with its top cut into other triangles."""
    angle = np.arange(6) * np.pi / 3
    ring = 0.5 + 0.35 * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.vstack([np.column_stack([ring, np.full(6, z)]) for z in (0.0, 1.0)])
    sides = [[k, (k + 1) % 6, 6 + (k + 1) % 6] for k in range(6)] + [
        [k, 6 + (k + 1) % 6, 6 + k] for k in range(6)
    ]
    bottom = [[0, k + 1, k] for k in range(1, 5)]
    top = [[8, 6 + (k + 3) % 6, 6 + (k + 4) % 6] for k in range(4)]
    return Mesh(points, np.array(sides + bottom + top))


def test_a_cell_drawn_in_openscad_passes_its_check(tmp_path):
    from amprep.pipeline.check_cell import check_cell

    path = tmp_path / "hexagon.stl"
    path.write_text(openscad_stl(hexagon_column()))
    host = Host.load(plugins_enabled=False)
    assert check_cell(cell_named(host, str(path)), steps=12).violations == ()
    mesh = cell_named(host, str(path)).emit(REQUEST).templates[0].mesh
    # bottom and top are cut into the same triangles, so that copies weld
    ends = [
        {tuple(sorted(map(tuple, c[:, :2]))) for c in mesh.vertices[mesh.triangles] if (c[:, 2] == z).all()}
        for z in (0, 1)
    ]
    assert len(ends[0]) == 4
    assert ends[0] == ends[1]


def test_a_level_of_effort_sets_the_budgets_of_the_packer_and_params_take_precedence(host):
    work = {level: choose_packer(host, PackingSettings(effort=level)).params.work for level in LEVELS}
    assert work["fast"] < work["normal"] < work["thorough"]
    chosen = choose_packer(host, PackingSettings(effort="thorough", params={"work": 7.0})).params
    assert (chosen.work, chosen.proof) == (7.0, 4000.0)


def test_every_level_of_every_packer_is_a_set_of_valid_parameters(host):
    for name, listed in host.offers("packer").items():
        for level in listed.offer.efforts:
            assert level in LEVELS
            assert choose_packer(host, PackingSettings(strategy=name, effort=level)).name == name


def test_a_packer_without_the_level_is_refused_with_what_to_do(host):
    with pytest.raises(JobError, match=r"'sweep' knows normal only, got 'fast'.*\[packing.params\]"):
        choose_packer(host, PackingSettings(strategy="sweep", effort="fast"))


@pytest.mark.parametrize(
    ("rule", "error", "message"),
    [
        ({"cell": "prisn"}, PluginError, r"\[\[rule\]\] 2: .*'prisn' .*did you mean 'prism'"),
        ({"cell": "prism", "params": {"windw": 1}}, JobError, r"\[\[rule\]\] 2: .*windw"),
    ],
)
def test_a_message_about_the_cell_of_a_rule_names_the_entry(host, rule, error, message):
    job = override(job_from_inputs(["part.stl"]), {"rule": [{"cell": "prism"}, rule]})
    with pytest.raises(error, match=message):
        resolve(job, host)
