"""What the user names: files, folders, counts; unique names; the promise of every part read."""

import pytest
import trimesh

from amprep import workers
from amprep.errors import AmprepError, InputError
from amprep.model import Mesh, Part
from amprep.pipeline import reading
from amprep.pipeline.reading import expand_inputs, read_all, with_unique_names
from amprep.plugins.readers.files import read_mesh_file

SUFFIXES = {".stl", ".3mf"}


def named(*names):
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    return [Part(name, mesh, 0.0) for name in names]


def test_files_stay_in_the_order_given(tmp_path):
    for name in ("b.stl", "a.stl"):
        (tmp_path / name).write_text("x")
    inputs = [(tmp_path / "b.stl", None), (tmp_path / "a.stl", 2)]
    assert expand_inputs(inputs, SUFFIXES) == inputs


def test_a_folder_stands_for_the_files_in_it_that_can_be_read_by_name(tmp_path):
    for name in ("b.STL", "a.stl", "notes.txt", "c.3mf", ".hidden.stl"):
        (tmp_path / name).write_text("x")
    (tmp_path / "deeper.stl").mkdir()
    assert [path.name for path, _ in expand_inputs([(tmp_path, None)], SUFFIXES)] == [
        "a.stl",
        "b.STL",
        "c.3mf",
    ]


def test_files_in_subfolders_are_read_but_no_build_files_of_earlier_runs_and_no_linked_folders(tmp_path):
    for name in ("b/c/1.stl", "a/2.stl", "0.stl", ".git/3.stl", "a/job.build-1.3mf", "a/job.build-12.4.stl"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x")
    (tmp_path / "a" / "again").symlink_to(tmp_path, target_is_directory=True)
    found = [path.relative_to(tmp_path).as_posix() for path, _ in expand_inputs([(tmp_path, None)], SUFFIXES)]
    assert found == ["0.stl", "a/2.stl", "b/c/1.stl"]


def test_a_folder_with_too_many_files_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "_MOST_FILES", 2)
    for number in range(3):
        (tmp_path / f"{number}.stl").write_text("x")
    with pytest.raises(InputError, match="more than 2 files"):
        expand_inputs([(tmp_path, None)], SUFFIXES)


def test_the_count_of_a_folder_holds_for_each_file_in_it(tmp_path):
    (tmp_path / "a.stl").write_text("x")
    (tmp_path / "b.stl").write_text("x")
    expected = [(tmp_path / "a.stl", 2), (tmp_path / "b.stl", 2)]
    assert expand_inputs([(tmp_path, 2)], SUFFIXES) == expected


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("none.stl", "no such file"),
        ("bracket.slt", r"no such file or folder \(did you mean 'bracket\.stl'\?\)"),
        ("bracket.stl:x", "a count of copies must be a whole number, as in bracket.stl:4"),
        ("empty", "no file to read"),
        ("\0", "not a usable"),
        ("x" * 5000, "too long"),
    ],
)
def test_what_is_not_there_is_refused_in_one_line(tmp_path, name, words):
    (tmp_path / "bracket.stl").write_text("x")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=words) as caught:
        expand_inputs([(tmp_path / name, None)], SUFFIXES)
    assert "\n" not in str(caught.value)


def test_equal_names_get_numbers_and_no_number_is_taken_twice():
    parts = with_unique_names(named("a", "b", "a", "a-2", "a"))
    assert [part.name for part in parts] == ["a", "b", "a-3", "a-2", "a-4"]


def test_reading_settles_counts_and_reports(tmp_path):
    path = tmp_path / "cube.stl"
    trimesh.creation.box((1, 2, 3)).export(path)
    heard = []
    parts = read_all([(path, 3), (path, None)], read_mesh_file, progress=lambda *said: heard.append(said))
    assert [(part.name, part.quantity, part.volume_mm3) for part in parts] == [
        ("cube", 3, 6.0),
        ("cube-2", 1, 6.0),
    ]
    assert heard == [(0.0, "cube.stl"), (0.5, "cube.stl"), (1.0, "2 parts")]


def test_meshes_are_repaired_by_several_processes_with_the_same_result(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "_WORTH_IT", 0.0)
    paths = [tmp_path / f"{name}.stl" for name in "abcd"]
    for size, path in enumerate(paths, start=1):
        box = trimesh.creation.box((size, size, size))
        box.invert()  # to be repaired
        box.export(path)
    found = []
    for count in (1, 3):
        with workers.allowed(count):
            found.append(read_all([(path, None) for path in paths], read_mesh_file))
    for one, other in zip(*found, strict=True):
        assert one.notes
        assert (one.name, one.notes, one.volume_mm3) == (other.name, other.notes, other.volume_mm3)
        assert (one.mesh.vertices == other.mesh.vertices).all()
        assert (one.mesh.triangles == other.mesh.triangles).all()
        assert not other.mesh.vertices.flags.writeable


def test_the_first_file_that_is_wrong_is_refused(tmp_path):
    (tmp_path / "a.stl").write_text("solid\nendsolid")
    box = trimesh.creation.box((1, 1, 1))
    box.update_faces([True] * 8 + [False] * 4)
    box.export(tmp_path / "open.stl")
    with pytest.raises(AmprepError, match=r"open.* is not a solid"):
        read_all([(tmp_path / "open.stl", None), (tmp_path / "a.stl", None)], read_mesh_file)
    with pytest.raises(AmprepError, match=r"a\.stl"):
        read_all([(tmp_path / "a.stl", None), (tmp_path / "open.stl", None)], read_mesh_file)
