"""Binary STL says the same triangles, in the same bytes every time."""

import numpy as np
import pytest
import trimesh

from amprep.errors import AmprepError
from amprep.model import Mesh
from amprep.stl import write_stl

# the corner of a cube: three right triangles and the slanted one, outward
CORNER = Mesh([[0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 0, 5]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def test_trimesh_reads_the_triangles_that_were_written(tmp_path):
    write_stl(CORNER, tmp_path / "a.stl")
    read = trimesh.load(tmp_path / "a.stl", process=False)
    assert read.triangles.tolist() == CORNER.vertices[CORNER.triangles].tolist()
    assert read.volume == pytest.approx(10.0)  # 3 * 4 * 5 / 6


def test_a_facet_takes_50_bytes_after_a_header_of_84(tmp_path):
    write_stl(CORNER, tmp_path / "a.stl")
    data = (tmp_path / "a.stl").read_bytes()
    assert len(data) == 84 + 4 * 50
    assert not data.startswith(b"solid")  # would be taken for ASCII
    assert np.frombuffer(data, "<f4", 3, 84).tolist() == [0, 0, -1]


def test_equal_meshes_give_equal_bytes(tmp_path):
    for name in ("a.stl", "b.stl"):
        write_stl(Mesh(CORNER.vertices, CORNER.triangles), tmp_path / name)
    assert (tmp_path / "a.stl").read_bytes() == (tmp_path / "b.stl").read_bytes()


def test_a_triangle_without_area_has_no_normal(tmp_path):
    write_stl(Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]), tmp_path / "a.stl")
    assert np.frombuffer((tmp_path / "a.stl").read_bytes(), "<f4", 3, 84).tolist() == [0, 0, 0]


def test_a_mesh_without_triangles_is_an_empty_stl(tmp_path):
    write_stl(Mesh(np.empty((0, 3)), np.empty((0, 3))), tmp_path / "a.stl")
    assert len((tmp_path / "a.stl").read_bytes()) == 84


def test_a_missing_folder_is_an_error_of_one_line(tmp_path):
    with pytest.raises(AmprepError, match="cannot write"):
        write_stl(CORNER, tmp_path / "nowhere" / "a.stl")
    assert not list(tmp_path.iterdir())
