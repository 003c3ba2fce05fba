"""Cells declared in files: TOML, meshes, and beams in 3MF."""

import numpy as np
import pytest

from amprep.host import Host
from amprep.testing.problems import box_mesh

POST = box_mesh(np.array([0.25, 0.25, 0.0]), np.array([0.75, 0.75, 1.0]))


def saved(mesh, path):
    import trimesh

    trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False).export(path)
    return path


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
        ("points = 3", "points must be a list of rows of 3 numbers"),
        ("points = [[0, 0]]\nstruts = [[0, 1]]", "points must be a list of rows of 3 numbers"),
        ("points = [[0, 0, nan], [0, 0, 1]]\nstruts = [[0, 1]]", "points must be a list of rows"),
        ("points = [[0, 0, 0], [0, 0, 2]]\nstruts = [[0, 1]]", "points must be inside the unit cube"),
        ("points = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 7]]", "struts must refer to points 0 to 1"),
        ("points = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 1.5]]", "must refer to points by number"),
        (
            "points = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 99999999999999]]",
            "struts|too large|out of bounds|convert",
        ),
        ("points = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 1, -1]]", "radii must be above 0"),
        ("struts = []", "a graph must have struts or faces"),
        ("point = [[0, 0, 0]]", r"unknown key 'point' \(did you mean 'points'\?\)"),
        ('mesh = "none.stl"', "mesh must name a mesh file in the same folder"),
        ('mesh = "/etc/passwd"', "mesh must name a mesh file in the same folder"),
        ("variant = 3", r"variants must be written as tables \[\[variant\]\]"),
        ("[[variant]]\nwhen = {role = 'roof'}\nstruts=[]", "roof|a graph must have struts"),
        ("[[variant]]\nwhen = {load = 3}\npoints=[[0,0,0],[0,0,1]]\nstruts=[[0,1]]", "load must be a pair"),
        ("size_mm = 0\npoints = []", "size_mm, the edge of the cube"),
        ("name = [", "not a TOML file"),
        ("name = 3\npoints = [[0, 0, 0], [0, 0, 1]]\nstruts = [[0, 1]]", "name must be a text of one line"),
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
