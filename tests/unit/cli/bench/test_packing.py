"""``amprep bench esicup`` packs several instances, and compares those of known sets with their records."""

import json

import pytest
import trimesh
from typer.testing import CliRunner

from amprep.cli.app import app


@pytest.fixture
def files(tmp_path):
    """Return a file named like an instance with a record, and another one."""
    paths = [tmp_path / "liu-2015" / "Experiment1.json", tmp_path / "mine" / "Cubes.json"]
    for path in paths:
        path.parent.mkdir()
        trimesh.creation.box((2.0, 2.0, 2.0)).export(path.parent / "cube.stl")
        rows = [{"path": "cube.stl", "demand": 3}]
        record = {"container": {"size-x": 4.0, "size-y": 2.0}, "item-types": rows}
        path.write_text(json.dumps(record), encoding="utf-8")
    return [str(path) for path in paths]


def test_ratios_are_means_over_the_instances_with_a_record(files):
    arguments = ["bench", "esicup", *files, "--packer", "extreme-points", "--time-limit", "5"]
    table, record = (CliRunner().invoke(app, [*arguments, *more]) for more in ([], ["--json"]))
    assert (table.exit_code, record.exit_code) == (0, 0)
    assert "liu-2015/Experiment1.json" in table.stdout
    assert "mean ratio to the record: 0.13" in table.stdout
    found = json.loads(record.stdout)
    assert found["mean"] == {"ratio": pytest.approx(4.0 / 30.55, rel=1e-3), "with_record": 1}
    assert [each["record_height_mm"] for each in found["instances"]] == [30.55, None]
    assert found["instances"][1]["mean"]["memory_mb"] > 10
    assert all(run["validated"] for each in found["instances"] for run in each["runs"])
