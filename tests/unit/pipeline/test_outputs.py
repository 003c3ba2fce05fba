"""The files of a run appear together, or not at all."""

import pytest

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
    assert (tmp_path / "job.report.json").read_text() == "new"
    assert (tmp_path / "mine.txt").read_text() == "mine"


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
    with (
        pytest.raises(InputError, match="cannot write to the output folder"),
        OutputFolder(tmp_path / "file", "job"),
    ):
        pass


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
