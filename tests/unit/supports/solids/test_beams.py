"""Beams are written, read back, clipped at parts, and judged together with the solids that they carry."""

import zipfile
from dataclasses import replace

import numpy as np
import pytest
from tests.shared.optional import present

from amprep.checks.supports.bodies import CLOSED, INSIDE, PENETRATION, STANDING, check_bodies
from amprep.errors import AmprepError
from amprep.geometry.supports.beams import near_surface, sample
from amprep.model import Beams, Build, BuildSettings, BuildVolume, Lattice, Mesh, Part, PlacedPart, Stop
from amprep.model import SupportBody as Body
from amprep.supports.solids.beams import clip_beams
from amprep.testing.problems import box_mesh
from amprep.threemf import read_build, write_build

SPACE = BuildVolume((50.0, 50.0, 50.0))
ROOM = np.array([np.zeros(3), SPACE.size])


def box(low, high):
    return box_mesh(np.array(low, np.float64), np.array(high, np.float64))


def built(lattice, part=None):
    """Return a build of a slab at z = 10 held by one lattice."""
    mesh = part or box((10, 10, 10), (20, 20, 12))
    placed = PlacedPart("slab", Part("slab", mesh, mesh.signed_volume), np.eye(4))
    return Build(
        BuildSettings("beams", SPACE), (placed,), (Body("s", lattice.stand_in, (0,), lattice=lattice),)
    )


def pin(**changes):
    """Return a leg of two beams that carries a plate below the slab."""
    nodes = [[15, 15, 0], [15, 15, 5], [16, 16, 9.0]]
    plate = box((14, 14, 8.9), (18, 18, 10.05))
    lattice = Lattice(
        nodes, [[0, 1], [1, 2]], [[0.5, 0.5], [0.5, 0.3]], plate, box((14, 14, 0), (18, 18, 10.05)), ROOM
    )
    return replace(lattice, **changes)


def promises(build):
    return [violation.promise for violation in check_bodies(build, Stop())]


def test_a_leg_on_the_plate_that_carries_a_solid_keeps_every_promise():
    assert promises(built(pin())) == []


@pytest.mark.parametrize(
    ("change", "promise"),
    [
        ({"radii": np.array([[0.5, 0.5], [0.5, 0.0]])}, CLOSED),
        ({"struts": np.array([[0, 1], [1, 1]])}, CLOSED),
        ({"nodes": np.array([[15, 15, 0], [15, 15, 5], [np.nan, 16, 9]])}, CLOSED),
        ({"room": None}, INSIDE),
        ({"nodes": np.array([[15, 15, 0], [15, 15, -5], [16, 16, 9.0]]), "room": None}, INSIDE),
        ({"nodes": np.array([[15, 15, 0], [15, 15, 5], [16, 16, 7.0]])}, STANDING),
        ({"nodes": np.array([[15, 15, 1], [15, 15, 5], [16, 16, 9.0]])}, STANDING),
        ({"nodes": np.array([[15, 15, 0], [15, 15, 5], [16, 16, 11.0]])}, PENETRATION),
    ],
)
def test_each_broken_promise_is_found(change, promise):
    assert promise in promises(built(pin(**change)))


def test_a_file_gives_the_beams_back(tmp_path):
    path = tmp_path / "beams.3mf"
    write_build(built(pin()), path)
    (body,) = read_build(path).supports
    lattice = present(body.lattice)
    assert lattice.nodes == pytest.approx(pin().nodes, abs=1e-6)
    assert lattice.struts.tolist() == [[0, 1], [1, 2]]
    assert lattice.radii == pytest.approx(pin().radii)
    assert lattice.solids.signed_volume == pytest.approx(pin().solids.signed_volume)
    assert body.mesh.signed_volume == pytest.approx(pin().stand_in.signed_volume)
    assert present(lattice.room).tolist() == ROOM.tolist()
    assert promises(read_build(path)) == []


def test_lib3mf_reads_beams_strictly_as_a_solid_support_with_a_representation_mesh(tmp_path):
    import lib3mf

    path = tmp_path / "beams.3mf"
    write_build(built(pin()), path)
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    objects = model.GetMeshObjects()
    found = []
    while objects.MoveNext():
        each = objects.GetCurrentMeshObject()
        if each.BeamLattice().GetBeamCount():
            found.append((each.GetType(), each.IsValid(), each.BeamLattice().GetRepresentation()[0]))
    assert found == [(lib3mf.ObjectType.SolidSupport, True, True)]


@pytest.mark.parametrize(("target", "beams"), [("generic", 2), ("prusaslicer", 0), ("cura", 0)])
def test_slicers_get_the_mesh(tmp_path, target, beams):
    build = built(pin())
    path = tmp_path / "beams.3mf"
    write_build(replace(build, settings=replace(build.settings, target=target)), path)
    with zipfile.ZipFile(path) as package:
        assert package.read("3D/3dmodel.model").count(b"<b:beam ") == beams
    (body,) = read_build(path).supports
    assert body.mesh.signed_volume == pytest.approx(pin().stand_in.signed_volume, rel=1e-5)


@pytest.mark.parametrize(("wish", "kind"), [("support", b"solidsupport"), ("model", b"model")])
def test_supports_have_the_requested_type(tmp_path, wish, kind):
    build = built(pin())
    path = tmp_path / "beams.3mf"
    write_build(replace(build, settings=replace(build.settings, supports_as=wish)), path)
    with zipfile.ZipFile(path) as package:
        assert b'name="s" type="' + kind + b'"' in package.read("3D/3dmodel.model")
    assert read_build(path).settings.supports_as == wish


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"radii": np.array([[0.5, 0.5], [0.5, -1.0]])}, "radius"),
        ({"struts": np.array([[0, 1], [1, 7]])}, "does not exist"),
        ({"nodes": np.zeros((3, 3))}, "shorter than"),
    ],
)
def test_beams_that_3mf_cannot_hold_are_refused_by_name(tmp_path, change, why):
    with pytest.raises(AmprepError, match=why):
        write_build(built(pin(**change)), tmp_path / "beams.3mf")


def test_beams_are_shortened_before_a_part_and_dropped_inside_it():
    nodes = np.array(
        [[5.0, 15, 11.5], [15, 15, 11.5], [12, 12, 11.5], [14, 14, 11.5], [30, 30, 0], [30, 30, 9]]
    )
    beams = Beams(nodes, np.array([[0, 1], [2, 3], [4, 5]], np.int32), np.full((3, 2), 0.4), np.zeros(3, int))
    slab = built(pin()).parts
    kept = clip_beams(beams, slab, (0,), SPACE, overlap=0.1, gap=0.0)
    assert len(kept.struts) == 2
    ends = sorted(kept.nodes[kept.struts[:, 1]].tolist())
    assert 9.3 <= ends[0][0] <= 9.6
    assert ends[1] == [30, 30, 9]
    apart = clip_beams(beams, slab, (0,), SPACE, overlap=0.1, gap=1.0)
    assert max(x for x in apart.nodes[apart.struts, 0].ravel().tolist() if x < 30) <= 8.6


def test_no_point_near_a_surface_is_missed():
    rng = np.random.default_rng(0)
    mesh = box((10, 10, 10), (20, 20, 12))
    points = rng.uniform(5, 25, (5000, 3))
    away = np.abs(np.maximum(np.maximum(mesh.bounds[0] - points, points - mesh.bounds[1]), 0.0))
    outside = np.linalg.norm(away, axis=1)
    near = near_surface(points, 0.5, mesh.vertices, mesh.triangles)
    assert near[(outside > 0) & (outside <= 0.5)].all()
    assert not near[outside > 4.0].any()


def test_balls_are_placed_from_end_to_end_with_interpolated_radii():
    places = sample(np.array([[0.0, 0, 0], [0, 0, 4]]), np.array([[0, 1]]), np.array([[1.0, 2.0]]))
    assert places.centres[:, 2].tolist() == pytest.approx(np.linspace(0, 4, 9).tolist())
    assert places.radii.tolist() == pytest.approx(np.linspace(1, 2, 9).tolist())


def test_a_mesh_without_triangles_beside_beams_is_no_fault():
    nodes = [[15.0, 15, 0], [15, 15, 9]]
    empty = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
    lattice = Lattice(nodes, [[0, 1]], [[0.5, 0.5]], empty, box((14, 14, 0), (16, 16, 9)), ROOM)
    assert promises(built(lattice)) == []
