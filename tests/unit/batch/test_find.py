"""Job files, and 3MF files that no job names, are the jobs of a folder."""

from pathlib import Path

import pytest

from amprep.batch.find import find_jobs
from amprep.errors import InputError


def write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        path = folder / name.replace("__", "/").replace("_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_jobs_of_a_folder_have_the_names_of_their_files(tmp_path: Path) -> None:
    write(
        tmp_path,
        a_toml='inputs = ["part.3mf"]',
        part_3mf="",
        plate_3mf="",
        sub__a_toml='[[part]]\nfile = "b.stl"',
        sub__b_stl="",
        printer_toml='name = "a printer"',
        broken_toml="= 1",
        x_build_1_3mf="",
        out__y_toml="inputs = []",
    )
    (tmp_path / "x.build.1.3mf").rename(tmp_path / "x.build-1.3mf")
    (tmp_path / ".hidden.3mf").write_text("")
    jobs = find_jobs([tmp_path], tmp_path / "out", ("--no-plugins",))
    assert [job.name for job in jobs] == ["a", "broken", "plate", "sub/a"]
    assert [job.folder for job in jobs] == [tmp_path / "out" / job.name for job in jobs]
    assert {job.arguments for job in jobs} == {("--no-plugins",)}


def test_jobs_with_equal_names_have_folders_of_their_own(tmp_path: Path) -> None:
    write(tmp_path, x__a_stl="", y__A_stl="", a__2_stl="")
    files = [tmp_path / "x" / "a.stl", tmp_path / "y" / "A.stl"]
    assert [job.name for job in find_jobs(files, tmp_path / "out", ())] == ["a", "A-2"]


def test_a_batch_without_a_job_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no job to run"):
        find_jobs([tmp_path], tmp_path / "out", ())
    with pytest.raises(InputError, match="no such file or folder"):
        find_jobs([tmp_path / "missing"], tmp_path / "out", ())
