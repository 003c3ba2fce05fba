"""The fixtures have the properties in fixtures/README.md, which follow from formulas, not from amprep."""

import io
import re
import sys
import zipfile
from math import cos, pi, radians, sqrt
from pathlib import Path

import numpy as np
import pytest
import trimesh
from manifold3d import Error, Manifold
from manifold3d import Mesh as ManifoldMesh
from tests.shared.optional import present

FOLDER = Path(__file__).parents[2] / "fixtures"
COMMITTED = sorted(
    str(path.relative_to(FOLDER).as_posix()) for path in FOLDER.rglob("*") if path.suffix in {".stl", ".3mf"}
)


@pytest.fixture(scope="module")
def scripts():
    """Import the scripts of the folder, which is not a package."""
    sys.path.insert(0, str(FOLDER))
    try:
        import demo_parts
        import make_fixtures
        import malformed
    finally:
        sys.path.remove(str(FOLDER))
    return make_fixtures, malformed, demo_parts


def load(name: str) -> trimesh.Trimesh:
    return trimesh.load_mesh(FOLDER / name)


def facing_down(mesh: trimesh.Trimesh, angle_deg: float = 45.0) -> np.ndarray:
    normals: np.ndarray = mesh.face_normals
    return normals[:, 2] < -cos(radians(angle_deg)) - 1e-6


def test_the_script_makes_every_committed_file_and_the_same_bytes_each_time(scripts):
    files = scripts[0].fixture_files()
    assert sorted(files) == COMMITTED
    assert files == scripts[0].fixture_files()
    assert sum((FOLDER / name).stat().st_size for name in COMMITTED) < 3_000_000


@pytest.mark.parametrize("name", ["ball", "two-balls", "table", "knife-edge"])
def test_simple_solids_are_solids_on_the_plate(name):
    mesh = load(f"{name}.stl")
    solid = Manifold(ManifoldMesh(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32)))
    assert solid.status() == Error.NoError
    assert mesh.is_watertight
    assert mesh.bounds[0][2] == 0.0


def test_the_wheel_has_its_web_marked_as_a_modifier():
    from amprep.threemf import read_parts

    (wheel,) = read_parts(FOLDER / "wheel.3mf")
    (web,) = wheel.regions
    ratio = 96 / (2 * pi) * np.sin(2 * pi / 96)
    assert (wheel.name, web.kind, web.name) == ("wheel", "lattice", "web")
    assert wheel.mesh.signed_volume == pytest.approx(pi * (20**2 - 4**2) * 12 * ratio)
    assert present(web.mesh).signed_volume == pytest.approx(pi * (16**2 - 7**2) * 14 * ratio)


def test_the_ball_has_the_volume_and_the_cap_of_a_ball_of_radius_10():
    ball = load("ball.stl")
    exact = 4 / 3 * pi * 10**3
    assert 0.994 * exact < ball.volume < exact
    cap = 2 * pi * 10**2 * (1 - cos(radians(45)))
    assert ball.area_faces[facing_down(ball)].sum() == pytest.approx(cap, rel=0.05)
    assert (ball.vertices[:, 2] < 1e-6).sum() == 1
    np.testing.assert_allclose(np.linalg.norm(ball.vertices - [0, 0, 10], axis=1), 10.0, atol=1e-4)


def test_the_two_balls_are_two_shells_24_mm_apart():
    below, above = sorted(load("two-balls.stl").split(), key=lambda shell: shell.bounds[0][2])
    exact = 4 / 3 * pi * 8**3
    assert [shell.volume / exact for shell in (below, above)] == pytest.approx([0.997, 0.997], abs=0.003)
    assert above.bounds[0][2] - below.bounds[1][2] == pytest.approx(24.0)
    cap = above.vertices[np.unique(above.faces[facing_down(above)])]
    assert np.hypot(cap[:, 0], cap[:, 1]).max() < 8.0


def test_the_table_hangs_over_1536_mm2():
    table = load("table.stl")
    assert table.volume == pytest.approx(40 * 40 * 4 + 4 * 4 * 4 * 20)
    down = facing_down(table)
    heights = table.triangles_center[down][:, 2]
    assert table.area_faces[down][heights > 19.9].sum() == pytest.approx(40 * 40 - 4 * 16)
    assert table.area_faces[down][heights < 0.1].sum() == pytest.approx(4 * 16)


def test_the_knife_edge_is_one_level_edge_of_30_mm_between_faces_of_60_degrees():
    beam = load("knife-edge.stl")
    assert beam.volume == pytest.approx(30 * 10 * 10 * sqrt(3) + 2 * 120 * 32, rel=1e-5)
    feet = facing_down(beam)
    assert beam.area_faces[feet].sum() == pytest.approx(240.0)
    assert beam.vertices[beam.faces[feet]][..., 2].max() == 0.0
    ends = beam.vertices[np.isclose(beam.vertices[:, 2], 12.0, atol=1e-4)]
    assert np.ptp(ends[:, 1]) == pytest.approx(30.0)
    sides = beam.face_normals[(beam.face_normals[:, 2] < -0.1) & ~feet]
    np.testing.assert_allclose(np.degrees(np.arccos(-sides[:, 2])), 60.0, atol=0.01)


def test_demo_parts_are_single_solids_of_a_size_one_prints(scripts):
    for part in scripts[2].PARTS:
        solid = part.make()
        low, high = np.reshape(solid.bounding_box(), (2, 3))
        assert solid.status() == Error.NoError, part.name
        assert len(solid.decompose()) == 1, part.name
        assert 10 <= min(high - low) <= max(high - low) <= 71, part.name
        assert 500 <= solid.num_tri() <= 6000, part.name


def test_the_demo_job_lists_twelve_parts_and_sixteen_copies():
    with zipfile.ZipFile(FOLDER / "demo/demo.3mf") as package:
        model = package.read("3D/3dmodel.model").decode()
    quantities = [int(found) for found in re.findall(r'"amprep:quantity"[^>]*>(\d+)<', model)]
    assert (len(quantities), sum(quantities)) == (12, 16)
    assert len(set(re.findall(r'object id="\d+" type="model" name="([^"]+)"', model))) == 12
    assert len(set(re.findall(r'displaycolor="([^"]+)"', model))) == 12


def test_malformed_meshes_are_broken_in_the_way_they_say():
    assert not load("malformed/open-box.stl").is_watertight
    inside_out = load("malformed/inside-out.stl")
    assert inside_out.is_watertight
    assert inside_out.volume == pytest.approx(-1000.0)
    truncated = (FOLDER / "malformed/truncated.stl").read_bytes()
    assert int.from_bytes(truncated[80:84], "little") == 12
    assert 84 + 5 * 50 < len(truncated) < 84 + 6 * 50
    assert (
        int.from_bytes((FOLDER / "malformed/huge-count.stl").read_bytes()[80:84], "little") == 4_000_000_000
    )


def test_the_zip_bomb_is_small_and_unpacks_to_what_was_asked_for(scripts, tmp_path):
    path = tmp_path / "bomb.3mf"
    scripts[1].write_zip_bomb(path, megabytes=8)
    assert path.stat().st_size < 20_000
    with zipfile.ZipFile(path) as package:
        assert 8 << 20 < package.getinfo("3D/3dmodel.model").file_size < 9 << 20


def test_entities_grow_tenfold_nine_times(scripts):
    with zipfile.ZipFile(io.BytesIO(scripts[1].entities())) as package:
        model = package.read("3D/3dmodel.model").decode()
    assert model.count("<!ENTITY") == 10
    assert model.count("&e8;") == 10
