"""A cell from a mesh file, and the judge of templates."""

from dataclasses import replace

import numpy as np
import pytest

from amprep.checks.cells.templates import check_cells, check_template
from amprep.errors import JobError, MeshError
from amprep.host import Host
from amprep.job import apply_sets, job_from_inputs
from amprep.model import CellRequest, Cells, Grid, Mesh, SupportEdges, Template
from amprep.pipeline.resolve import cell_named, choose_cell
from amprep.testing.problems import box_mesh

POST = box_mesh(np.array([0.25, 0.25, 0.0]), np.array([0.75, 0.75, 1.0]))
FRAME = Grid(np.zeros(3), pitch=2.0, step=4.0, shape=(3, 3, 3))
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


GRAPH = """
name = "tree"
summary = "A trunk with branches."
author = "A. N. Engineer"
licence = "MIT"
smallest_feature_mm = 0.3
least_angle_deg = 45
radius_mm = 0.25
points = [[0.5, 0.5, 0], [0.5, 0.5, 1]]
struts = [[0, 1, 0.4]]

[[variant]]
when = {role = "foot", edges = "straight", load = [1, 5], every = 2, layer = 0}
growth = 1.5
full_load = 5
points = [[0.5, 0.5, 0], [0.5, 0.5, 1], [0.2, 0.5, 0]]
struts = [[0, 1, 0.4], [2, 1, 0.2, 0.3]]
"""


def read(path):
    from amprep.cells import read_cell

    host = Host.load(plugins_enabled=False)

    def mesh(file):
        listed = host.reader_for(file)
        return host.call(listed, file, params=host.params(listed, {}))[0].mesh

    return read_cell(path, mesh)


def test_a_toml_file_declares_a_graph_with_variants(tmp_path):
    path = tmp_path / "tree.toml"
    path.write_text(GRAPH)
    found = read(path)
    foot, usual = found.cell.variants
    assert (found.name, found.summary) == ("tree", "A trunk with branches.")
    assert (found.cell.author, found.cell.licence) == ("A. N. Engineer", "MIT")
    assert (found.cell.smallest_feature, found.cell.least_angle_deg) == (0.3, 45.0)
    assert (foot.when.roles, foot.when.edges, foot.when.most_load) == ({"foot"}, "straight", 5)
    assert foot.shape.radii.tolist() == [[0.4, 0.4], [0.2, 0.3]]
    assert (foot.shape.growth, usual.shape.growth) == (1.5, 1.0)


def test_a_toml_beside_a_mesh_says_who_made_it_and_how_large_it_is_drawn(tmp_path):
    saved(POST.moved(np.diag([10.0, 10, 10, 1])), tmp_path / "post.stl")
    (tmp_path / "post.toml").write_text('name = "Post"\nauthor = "me"\nsize_mm = 10\n')
    found = read(tmp_path / "post.stl")
    assert (found.name, found.cell.author, found.cell.kinds) == ("Post", "me", ("mesh",))
    assert found.cell.variants[0].shape.mesh.bounds[1] == pytest.approx([0.75, 0.75, 1.0])


def test_variants_may_be_meshes_of_their_own(tmp_path):
    saved(POST, tmp_path / "post.stl")
    saved(box_mesh(np.zeros(3), np.ones(3)), tmp_path / "base.stl")
    path = tmp_path / "column.toml"
    path.write_text('mesh = "post.stl"\n[[variant]]\nwhen = {role = ["foot"]}\nmesh = "base.stl"\n')
    base, post = (variant.shape.mesh.signed_volume for variant in read(path).cell.variants)
    assert (base, post) == pytest.approx((1.0, 0.25))


def test_beams_in_a_3mf_file_are_a_graph(tmp_path):
    import lib3mf

    model = lib3mf.get_wrapper().CreateModel()
    thing = model.AddMeshObject()
    for point in ((0.5, 0.5, 0.0), (0.5, 0.5, 1.0), (0.0, 0.5, 0.5)):
        thing.AddVertex(lib3mf.Position(Coordinates=point))
    lattice = thing.BeamLattice()
    lattice.SetMinLength(0.001)
    for ends, radii in (((0, 1), (0.3, 0.3)), ((0, 2), (0.3, 0.2))):
        lattice.AddBeam(lib3mf.Beam(Indices=ends, Radii=radii, CapModes=(0, 0)))
    model.AddBuildItem(thing, lib3mf.get_wrapper().GetIdentityTransform())
    path = tmp_path / "beams.3mf"
    model.QueryWriter("3mf").WriteToFile(str(path))
    (variant,) = read(path).cell.variants
    assert variant.shape.points.tolist() == [[0.5, 0.5, 0.0], [0.5, 0.5, 1.0], [0.0, 0.5, 0.5]]
    assert variant.shape.struts.tolist() == [[0, 1], [0, 2]]
    assert variant.shape.radii == pytest.approx(np.array([[0.3, 0.3], [0.3, 0.2]]))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("points = 3", "points is a list of rows of 3 numbers"),
        ("points = [[0, 0]]\nstruts = [[0, 1]]", "points is a list of rows of 3 numbers"),
        ("points = [[0, 0, nan], [0, 0, 1]]\nstruts = [[0, 1]]", "points is a list of rows"),
        ("points = [[0, 0, 0], [0, 0, 2]]\nstruts = [[0, 1]]", "points lie in the unit cube"),
        ("points = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 7]]", "struts name points from 0 to 1"),
        ("points = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 1.5]]", "name points by their numbers"),
        (
            "points = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 99999999999999]]",
            "struts|too large|out of bounds|convert",
        ),
        ("points = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 1, -1]]", "radii are above 0"),
        ("struts = []", "a graph has struts or faces"),
        ("point = [[0, 0, 0]]", r"unknown key 'point' \(did you mean 'points'\?\)"),
        ('mesh = "none.stl"', "mesh names a mesh file beside it"),
        ('mesh = "/etc/passwd"', "mesh names a mesh file beside it"),
        ("variant = 3", r"variants are written as tables \[\[variant\]\]"),
        ("[[variant]]\nwhen = {role = 'roof'}\nstruts=[]", "roof|a graph has struts"),
        ("[[variant]]\nwhen = {load = 3}\npoints=[[0,0,0],[0,0,1]]\nstruts=[[0,1]]", "load is a pair"),
        ("size_mm = 0\npoints = []", "size_mm is the side of the cube"),
        ("name = [", "not a TOML file"),
        ("name = 3\npoints = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 1]]", "name is a text of one line"),
    ],
)
def test_a_wrong_toml_file_is_refused_in_one_line(tmp_path, text, reason):
    from amprep.errors import InputError

    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=reason) as caught:
        read(path)
    assert "wrong.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


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
    from amprep.cells.emission import emit_declared
    from amprep.pipeline.check_cell import check_cell

    path = tmp_path / "hexagon.stl"
    path.write_text(openscad_stl(hexagon_column()))
    host = Host.load(plugins_enabled=False)
    assert check_cell(cell_named(host, str(path)), steps=12).violations == ()
    mesh = emit_declared(read(path).cell, REQUEST).templates[0].mesh
    # bottom and top are cut into the same triangles, so that copies weld
    ends = [
        {tuple(sorted(map(tuple, c[:, :2]))) for c in mesh.vertices[mesh.triangles] if (c[:, 2] == z).all()}
        for z in (0, 1)
    ]
    assert len(ends[0]) == 4
    assert ends[0] == ends[1]
