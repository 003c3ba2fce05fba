"""``amprep bench support-volume`` compares the supports of given files with straight columns."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from amprep.cli.app import app

TABLE = Path(__file__).parents[4] / "fixtures" / "table.stl"


@pytest.fixture(autouse=True)
def no_slicer(monkeypatch):
    monkeypatch.setattr("amprep.bench.prusaslicer.find_slicer", lambda: None)


def test_a_file_is_compared_in_a_line_or_json():
    arguments = ["bench", "support-volume", str(TABLE), "--no-generated", "--pitch", "5", "--cell", "prism"]
    line, record = (CliRunner().invoke(app, [*arguments, *more]) for more in ([], ["--json"]))
    assert (line.exit_code, record.exit_code) == (0, 0), line.output
    assert "straight columns" in line.stdout
    found = json.loads(record.stdout)
    assert (found["cell"], found["pitch_mm"], len(found["results"])) == ("prism", 5.0, 1)
    (result,) = found["results"]
    assert 0 < result["fraction_of_straight"]["shortest-paths"] <= 1.5
