"""The log says what was done, and what ended the run."""

import pytest
from tests.shared.builds import box_mesh
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.cli.log import logging_to
from amprep.errors import AmprepError
from amprep.stl import write_stl


def test_a_run_is_logged_by_stages_and_the_report_is_opened(tmp_path, monkeypatch):
    opened: list[str] = []
    monkeypatch.setattr("typer.launch", opened.append)
    write_stl(box_mesh((0, 0, 0), (5, 5, 5)), tmp_path / "box.stl")
    log = tmp_path / "run.log"
    command = [
        "run",
        str(tmp_path / "box.stl"),
        "--set",
        "supports.enabled=false",
        "-q",
        "--log",
        str(log),
        "--open",
    ]
    assert CliRunner().invoke(app, command).exit_code == 0
    assert opened == [str(tmp_path / "box.report.html")]
    lines = log.read_text(encoding="utf-8").splitlines()
    assert "amprep 0" in lines[0]
    assert any("read: done in " in line for line in lines)
    assert "finished after" in lines[-1]


def test_an_error_ends_the_log(tmp_path):
    with pytest.raises(ValueError, match="why"), logging_to(tmp_path / "log") as log:  # noqa: PT012
        log("two\nlines")
        raise ValueError("why")
    lines = (tmp_path / "log").read_text(encoding="utf-8").splitlines()
    assert lines[1].endswith(" two lines")
    assert lines[2].endswith("by ValueError: why")


def test_a_log_that_cannot_be_written_is_an_error_and_none_is_no_log(tmp_path):
    with pytest.raises(AmprepError, match="cannot write the log"), logging_to(tmp_path):
        pass
    with logging_to(None) as log:
        log("nowhere")
