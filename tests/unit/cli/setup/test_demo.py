"""`amprep demo` runs the job that comes with amprep, into a folder of its own."""

from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.cli.setup import demo
from amprep.job import load_job


@pytest.mark.parametrize(("given", "folder"), [((), "amprep-demo"), (("-o", "here"), "here")])
def test_the_demo_job_is_run(monkeypatch, given, folder):
    seen = []

    def run(function, inputs, options, changes):
        seen.append((function, inputs, options.output))
        raise typer.Exit(0)

    monkeypatch.setattr(demo, "build_and_report", run)
    assert CliRunner().invoke(app, ["demo", *given]).exit_code == 0
    ((function, (job,), output),) = seen
    assert (function, str(output)) == ("run", folder)
    assert load_job(Path(job)).inputs[0].path.is_file()
