"""`amprep init` writes a job file that runs, and nothing where a name is wrong."""

import pytest
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.errors import AmprepError
from amprep.job import load_job


@pytest.fixture(autouse=True)
def parts(tmp_path):
    (tmp_path / "parts").mkdir()
    for name in ("a.stl", "b.stl"):
        (tmp_path / "parts" / name).touch()


def init(*arguments):
    return CliRunner().invoke(app, ["init", *map(str, arguments)])


def test_the_file_holds_inputs_relative_to_itself_and_the_options(tmp_path):
    path = tmp_path / "jobs" / "new.toml"
    path.parent.mkdir()
    result = init(
        tmp_path / "parts" / "a.stl:2",
        "-o",
        path,
        "--printer",
        "eos-m290",
        "--packer",
        "sweep",
        "--for",
        "cura",
    )
    assert result.exit_code == 0, result.output
    job = load_job(path)
    assert (job.inputs[0].path.resolve(), job.inputs[0].quantity) == (tmp_path / "parts" / "a.stl", 2)
    assert (job.printer.name, job.packing.strategy, job.target) == ("EOS M290", "sweep", "cura")
    assert isinstance(init(tmp_path / "parts" / "a.stl", "-o", path).exception, AmprepError)
    assert init(tmp_path / "parts" / "b.stl", "-o", path, "--force").exit_code == 0
    assert load_job(path).inputs[0].path.name == "b.stl"


@pytest.mark.parametrize(
    "wrong", [("--printer", "eos m29"), ("--packer", "sweeep"), ("--cell", "x-wal"), ("--material", "ti6al4")]
)
def test_a_wrong_name_is_told_and_no_file_appears(tmp_path, wrong):
    result = init(tmp_path / "parts" / "a.stl", "-o", tmp_path / "job.toml", *wrong)
    assert "did you mean" in str(result.exception)
    assert [path.name for path in tmp_path.iterdir()] == ["parts"]


def test_a_name_of_a_file_with_a_line_feed_is_refused(tmp_path):
    assert isinstance(init(tmp_path / "parts" / "a.stl", "-o", tmp_path / "a\nb.toml").exception, AmprepError)
    assert [path.name for path in tmp_path.iterdir()] == ["parts"]


def test_a_job_that_could_not_run_is_not_written(tmp_path):
    (tmp_path / "empty").mkdir()
    path = tmp_path / "job.toml"
    assert "no file to read in this folder" in str(init(tmp_path / "empty", "-o", path).exception)
    assert "did you mean" in str(init(tmp_path / "parts" / "c.stl", "-o", path).exception)
    assert (
        init(tmp_path / "parts", "-o", path, "--for", "prusa").exception.args[0].startswith("--for: expected")
    )
    assert not path.exists()
