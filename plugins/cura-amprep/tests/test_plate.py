"""The models of a scene reach amprep with their shapes and places; groups stay together, copies share their mesh."""

import zipfile
from io import BytesIO
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from cura_amprep.bed import bed_of
from cura_amprep.model_file import write_models
from cura_amprep.plate import models_on
from stand_ins import Mesh, Node

import amprep

SIZES = {"machine_width": 200, "machine_depth": 100, "machine_height": 150}
BED = bed_of("machine", SIZES.get)


def loaded(nodes, tmp_path):
    """The parts that amprep reads from the file of a scene, and their boxes where the file places them."""
    path = tmp_path / "plate.3mf"
    with path.open("wb") as stream:
        write_models(models_on(Node(children=nodes), 0, BED.from_scene()), stream)
    return amprep.load(path).parts


def test_cura_writes_x_to_the_right_z_to_the_front_and_y_up_from_the_middle(tmp_path):
    # 10 wide, 30 high, 20 deep, at the right back of the middle
    (part,) = loaded([Node(Mesh((10, 30, 20)), (50, 0, -40), name="tower")], tmp_path)
    assert part.name == "tower"
    np.testing.assert_allclose(np.ptp(part.mesh.vertices, axis=0), (10, 20, 30), atol=1e-5)
    models = models_on(Node(children=[Node(Mesh((10, 30, 20)), (50, 0, -40))]), 0, BED.from_scene())
    body = models[0].bodies[0]
    corners = body.vertices @ body.transform[:3, :3].T + body.transform[:3, 3]
    np.testing.assert_allclose(corners.min(axis=0), (150, 70, 0))
    np.testing.assert_allclose(corners.max(axis=0), (160, 90, 30))


def test_a_mesh_without_indices_becomes_a_closed_solid(tmp_path):
    (part,) = loaded([Node(Mesh((10, 10, 10), indexed=False))], tmp_path)
    assert len(part.mesh.vertices) == 8
    assert not part.notes


def test_a_group_is_one_part(tmp_path):
    halves = [Node(Mesh((10, 10, 10)), (at, 0, 0)) for at in (0, 20)]
    (part,) = loaded([Node(name="both", children=halves)], tmp_path)
    np.testing.assert_allclose(np.ptp(part.mesh.vertices, axis=0), (30, 10, 10), atol=1e-5)


def test_copies_share_their_mesh_and_names_may_contain_anything():
    mesh = Mesh()
    nodes = [Node(mesh, (10 * place, 0, 0), name='a<"&\x00>') for place in range(3)]
    stream = BytesIO()
    write_models(models_on(Node(children=nodes), 0, BED.from_scene()), stream)
    with zipfile.ZipFile(stream) as package:
        tree = ET.fromstring(package.read("3D/3dmodel.model"))
    space = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    assert [each.get("name") for each in tree.iter(space + "object")] == ['a<"&>']
    assert [each.get("objectid") for each in tree.iter(space + "item")] == ["1", "1", "1"]


@pytest.mark.parametrize(
    "decorations",
    [
        {"getBuildPlateNumber": 1},
        {"isSliceable": False},
        {"isNonPrintingMesh": True},
        {"isSupportMesh": True},
    ],
)
def test_what_is_not_printed_on_this_plate_is_left_out(decorations):
    nodes = [Node(Mesh(), **decorations), Node()]
    assert models_on(Node(children=nodes), 0, BED.from_scene()) == []
