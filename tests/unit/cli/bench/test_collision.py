"""``amprep bench collision`` prints a line per query or JSON, and its exit code tells whether all answers are right."""

import json

from typer.testing import CliRunner

from amprep.cli.app import app

ARGUMENTS = ["bench", "collision", "--triangles", "500", "--poses", "5", "--no-pieces", "--no-rivals"]


def test_the_result_is_a_line_for_each_query_or_json():
    lines, record = (CliRunner().invoke(app, [*ARGUMENTS, *more]) for more in ([], ["--json"]))
    assert (lines.exit_code, record.exit_code) == (0, 0)
    assert lines.stdout.count("OBB trees: ") == 3
    found = json.loads(record.stdout)
    assert found["parts"] == ["bracket", "tube"]
    assert [each["query"] for each in found["results"]] == ["collide", "distance", "directional"]
