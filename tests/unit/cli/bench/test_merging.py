"""``amprep bench merging`` prints a line or JSON, and its exit code tells whether the meshes agree."""

import json

from typer.testing import CliRunner

from amprep.cli.app import app


def test_the_result_is_a_line_or_json():
    arguments = ["bench", "merging", "--cells", "60", "--sample", "20"]
    line, record = (CliRunner().invoke(app, [*arguments, *more]) for more in ([], ["--json"]))
    assert (line.exit_code, record.exit_code) == (0, 0)
    assert "batch union" in line.stdout
    found = json.loads(record.stdout)
    assert found["benchmark"] == "merging"
    assert found["results"][0]["validated"] is True
