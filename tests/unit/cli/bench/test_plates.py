"""``amprep bench plates`` compares packers in one table or as JSON."""

import json

import pytest
import trimesh
from typer.testing import CliRunner

from amprep.cli.app import app


@pytest.fixture
def folder(tmp_path):
    for k, size in enumerate(((30.0, 10.0, 5.0), (12.0, 12.0, 4.0))):
        trimesh.creation.box(size).export(tmp_path / f"{k}.stl")
    return str(tmp_path)


def test_packers_stand_side_by_side(folder):
    arguments = ["bench", "plates", folder, "--size", "40x40", "--time-limit", "5"]
    arguments += ["--packer", "extreme-points", "--packer", "sweep"]
    table, record = (CliRunner().invoke(app, [*arguments, *more]) for more in ([], ["--json"]))
    assert (table.exit_code, record.exit_code) == (0, 0)
    assert "1 pair by their enclosing boxes" in table.stdout
    found = json.loads(record.stdout)
    assert [(each["packer"], each["plates"]) for each in found["results"]] == [
        ("extreme-points", 1),
        ("sweep", 1),
    ]
    assert found["parts"] == 2


@pytest.mark.parametrize("size", ["40", "0x40", "40 by 40"])
def test_a_plate_without_two_sides_is_refused(folder, size):
    outcome = CliRunner().invoke(app, ["bench", "plates", folder, "--size", size])
    assert outcome.exit_code != 0
    assert "expected two lengths" in str(outcome.exception)
