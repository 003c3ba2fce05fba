"""The text of meshes and beams states each coordinate exactly, and refuses what 3MF cannot store."""

import re
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.errors import AmprepError
from amprep.model import Appearance, Mesh
from amprep.threemf.write.document import BeamSet, MeshObject
from amprep.threemf.write.geometry import Palette, check_geometry, mesh_text, text_size

TETRAHEDRON = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
NODES = np.array([[0.0, 0, 0], [5, 0, 0], [5, 5, 0], [5, 5, 5]])


def parsed(thing, palette=None, object_ids=()):
    text = b"".join(mesh_text(thing, palette, object_ids)).decode()
    return ET.fromstring(re.sub(r"\bb:", "", text))


def numbers(elements, *names):
    return [[float(each.get(name, "nan")) for name in names] for each in elements]


@given(st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 3), min_size=3, max_size=3))
def test_vertices_come_back_as_the_digest_counts_them(points):
    mesh = Mesh(points, [[0, 1, 2]])
    back = numbers(parsed(MeshObject("a", mesh)).iter("vertex"), "x", "y", "z")
    assert Mesh(back, mesh.triangles).digest == mesh.digest


def test_triangles_come_back_in_their_order():
    back = numbers(parsed(MeshObject("a", TETRAHEDRON)).iter("triangle"), "v1", "v2", "v3")
    assert back == TETRAHEDRON.triangles.tolist()


def test_colours_are_indices_into_the_palette_and_uncoloured_triangles_have_none():
    red, blue = 0xFF0000FF, 0x0000FFFF
    colours = np.array([[red] * 3, [-1] * 3, [blue] * 3, [red, red, blue]])
    coloured = MeshObject("a", TETRAHEDRON, appearance=Appearance(triangle_colours=colours))
    palette = Palette(7, np.array([blue, red]))
    triangles = list(parsed(coloured, palette).iter("triangle"))
    assert [each.get("pid") for each in triangles] == ["7", None, "7", "7"]
    assert [each.get("p3") for each in triangles] == ["1", None, "0", "0"]


def test_beams_follow_the_vertices_and_omit_the_most_frequent_radius():
    radii = np.array([[1.0, 1.0], [1.0, 1.0], [1.0, 0.5]])
    beams = BeamSet(NODES, np.array([[0, 1], [1, 2], [2, 3]]), radii, stand_in=0, clipping=1)
    mesh = parsed(MeshObject("a", TETRAHEDRON, beams=beams), None, object_ids=(11, 12, 13))
    lattice = mesh.find("beamlattice")
    assert (lattice.get("radius"), lattice.get("representationmesh"), lattice.get("clippingmesh")) == (
        "1",
        "11",
        "12",
    )
    found = list(lattice.iter("beam"))
    assert numbers(found, "v1", "v2") == [[4, 5], [5, 6], [6, 7]]
    assert [(each.get("r1"), each.get("r2")) for each in found] == [(None, None), (None, None), ("1", "0.5")]
    assert len(list(mesh.iter("vertex"))) == 8


def test_a_body_of_beams_only_has_no_triangles_element():
    empty = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
    beams = BeamSet(NODES, np.array([[0, 1]]), np.ones((1, 2)), stand_in=0)
    mesh = parsed(MeshObject("a", empty, beams=beams), None, object_ids=(1, 2))
    assert mesh.find("triangles") is None
    assert numbers(mesh.iter("beam"), "v1", "v2") == [[0, 1]]


@pytest.mark.parametrize(
    ("nodes", "struts", "radii", "message"),
    [
        (NODES, [[0, 4]], [[1.0, 1.0]], "refers to a node that does not exist"),
        (NODES, np.empty((0, 2), int), np.empty((0, 2)), "no beams"),
        (NODES, [[0, 1]], [[1.0, 0.0]], "must be above 0"),
        (NODES, [[1, 1]], [[1.0, 1.0]], "shorter than"),
        (NODES + np.inf, [[0, 1]], [[1.0, 1.0]], "not finite"),
    ],
)
def test_beams_that_3mf_cannot_store_are_refused(nodes, struts, radii, message):
    beams = BeamSet(nodes, np.asarray(struts), np.asarray(radii), stand_in=0)
    with pytest.raises(AmprepError, match=message):
        check_geometry(MeshObject("a", TETRAHEDRON, beams=beams))


@given(st.integers(1, 30), st.integers(0, 2**32 - 1))
def test_the_text_is_never_longer_than_its_bound(triangles, seed):
    rng = np.random.default_rng(seed)
    mesh = Mesh(rng.uniform(-9e8, 9e8, (30, 3)), rng.integers(0, 30, (triangles, 3)))
    thing = MeshObject("a", mesh, beams=BeamSet(NODES, np.array([[0, 1]]), np.full((1, 2), 1 / 3), 0))
    assert len(b"".join(mesh_text(thing, None, (1, 2)))) <= text_size(thing)
