"""Progress as lines of JSON: what a program that starts amprep reads on standard error."""

import json

from tests.shared.builds import box_mesh
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.cli.progress import Lines
from amprep.stl import write_stl


def test_a_line_appears_only_where_a_percent_or_the_message_changes(capsys):
    logged: list[str] = []
    with Lines(logged.append) as lines, lines.stage("pack") as progress:
        for step in range(1000):
            progress(step / 2000, "first" if step < 500 else "second")
        progress(7.0, "beyond")
    printed = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert [each["stage"] for each in printed] == ["pack"] * len(printed)
    fractions = [each["fraction"] for each in printed]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[-1] == 1.0
    assert 50 <= len(printed) <= 56
    assert [line for line in logged if "done" not in line] == ["pack: first", "pack: second", "pack: beyond"]


def test_a_run_keeps_standard_output_for_the_report_and_standard_error_for_lines(tmp_path):
    box = str(tmp_path / "box.stl")
    write_stl(box_mesh((0, 0, 0), (5, 5, 5)), tmp_path / "box.stl")
    command = ["run", box, "--set", "supports.enabled=false", "--dry-run", "--json", "--progress", "lines"]
    ended = CliRunner().invoke(app, command)
    assert ended.exit_code == 0
    assert json.loads(ended.stdout)["builds"][0]["parts"][0]["part"] == "box"
    stages = [json.loads(line)["stage"] for line in ended.stderr.splitlines()]
    assert stages[0] == "start"
    assert "pack" in stages
