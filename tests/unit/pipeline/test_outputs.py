"""The files of a run appear together, or not at all."""

import os
import shutil
import signal
from pathlib import Path

import pytest

from amprep import interruption
from amprep.errors import InputError
from amprep.pipeline.outputs import OutputFolder, safe_name


def test_files_appear_when_they_are_published(tmp_path):
    folder = tmp_path / "new" / "folder"
    with OutputFolder(folder, "job") as outputs:
        outputs.path("build-1.3mf").write_text("a")
        outputs.path("report.json").write_text("b")
        assert [path.name for path in folder.iterdir() if not path.name.startswith(".")] == []
        outputs.publish()
    assert sorted(path.name for path in folder.iterdir()) == ["job.build-1.3mf", "job.report.json"]


def test_after_an_exception_no_file_and_no_new_folder_appears(tmp_path):
    folder = tmp_path / "folder"

    def interrupted():
        with OutputFolder(folder, "job") as outputs:
            outputs.path("build-1.3mf").write_text("a")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not folder.exists()


def test_an_older_file_of_the_same_name_is_replaced_and_others_stay(tmp_path):
    (tmp_path / "job.report.json").write_text("old")
    (tmp_path / "mine.txt").write_text("mine")
    with OutputFolder(tmp_path, "job") as outputs:
        outputs.path("report.json").write_text("new")
        outputs.publish()
    assert (tmp_path / "job.report.json").read_text(encoding="utf-8") == "new"
    assert (tmp_path / "mine.txt").read_text(encoding="utf-8") == "mine"


def test_builds_are_numbered_unless_there_is_only_one(tmp_path):
    assert OutputFolder(tmp_path, "job").of_build(2, "3mf") == "build-2.3mf"
    assert OutputFolder(tmp_path, "job", numbered=False).of_build(2, "3mf") == "3mf"


def test_builds_of_an_earlier_run_with_more_builds_are_named(tmp_path):
    for name in (
        "job.build-1.3mf",
        "job.build-3.3mf",
        "job.build-12.3mf",
        "jobs.build-9.3mf",
        "job.build-x.3mf",
    ):
        (tmp_path / name).touch()
    assert OutputFolder(tmp_path, "job").stale_builds(2) == ["job.build-12.3mf", "job.build-3.3mf"]


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "file").touch()
    for folder in (tmp_path / "file", tmp_path / "file" / "in it"):
        with pytest.raises(InputError, match=r"cannot write to the output folder .*file is a file"):
            OutputFolder(folder, "job")


def contents(folder):
    return {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir() if path.is_file()}


def write_two(folder, before_publishing=lambda: None):
    """Write and publish two files."""
    with OutputFolder(folder, "job") as outputs:
        outputs.path("a").write_text("new")
        outputs.path("b").write_text("new")
        before_publishing()
        outputs.publish()


@pytest.mark.parametrize("number", interruption.SIGNALS)
@pytest.mark.parametrize("renamed", [0, 1, 2, 3])
def test_a_signal_while_files_appear_leaves_all_of_them(tmp_path, monkeypatch, number, renamed):
    """Signals of a program with handlers of its own arrive when everything is in place."""
    got, calls, replace = [], [], Path.replace

    def replace_and_signal(path, target):
        calls.append(path.name)
        if len(calls) - 1 == renamed:
            signal.raise_signal(number)
        return replace(path, target)

    before = signal.signal(number, lambda *_: got.append(set(contents(tmp_path))))
    monkeypatch.setattr(Path, "replace", replace_and_signal)
    write_two(tmp_path)
    signal.signal(number, before)
    assert got == [{"job.a", "job.b"}] * (renamed < len(calls))
    assert set(contents(tmp_path)) == {"job.a", "job.b"}


def test_a_folder_where_a_file_must_be_is_named_and_nothing_appears(tmp_path):
    (tmp_path / "job.b").mkdir()
    with pytest.raises(InputError, match=r"cannot write .*job\.b: a folder has this name; move it away"):
        write_two(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["job.b"]


def test_files_move_back_if_one_cannot_appear(tmp_path, monkeypatch):
    (tmp_path / "job.a").write_text("old")
    replace = Path.replace

    def refuse_b(path, target):
        if path.name == "job.b":
            raise PermissionError(1, "Operation not permitted")
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", refuse_b)
    with pytest.raises(InputError, match=r"cannot write to the output folder .*: Operation not permitted"):
        write_two(tmp_path)
    assert contents(tmp_path) == {"job.a": "old"}
    assert len(list(tmp_path.iterdir())) == 1


def test_a_link_with_the_name_of_a_file_is_replaced_and_its_target_stays(tmp_path):
    secret, folder = tmp_path / "secret", tmp_path / "out"
    secret.write_text("old")
    folder.mkdir()
    (folder / "job.a").symlink_to(secret)
    (folder / "job.b").symlink_to(tmp_path)
    write_two(folder)
    assert secret.read_text(encoding="utf-8") == "old"
    assert not (folder / "job.a").is_symlink()
    assert contents(folder) == {"job.a": "new", "job.b": "new"}


def test_a_folder_that_vanishes_is_one_error(tmp_path):
    with pytest.raises(InputError, match="cannot write to the output folder"):
        write_two(tmp_path / "out", lambda: shutil.rmtree(tmp_path / "out"))
    assert list(tmp_path.iterdir()) == []


def test_a_vanished_folder_has_no_older_builds(tmp_path):
    assert OutputFolder(tmp_path / "gone", "job").stale_builds(1) == []


@pytest.mark.skipif(os.getuid() == 0, reason="nothing is read-only for root")
def test_a_read_only_folder_is_refused_before_the_work(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="cannot write to the output folder"):
        write_two(tmp_path)


def test_every_folder_that_a_failed_run_made_is_removed(tmp_path):
    def fail():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_two(tmp_path / "a" / "b" / "c", fail)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("a/b\\c", "a_b_c"),
        ("..", "unnamed"),
        ("", "unnamed"),
        ("Größe 1-2", "Größe 1-2"),
        ("x" * 300, "x" * 100),
    ],
)
def test_names_stay_in_their_folder(text, name):
    assert safe_name(text) == name
