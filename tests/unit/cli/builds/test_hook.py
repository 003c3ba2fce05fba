"""`amprep hook`: exit codes, and where messages go."""

import json

import pytest
from tests.shared.gcode import L_PRISMS, Slicer, prepared
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.threemf import write_build

RUNNER = CliRunner()


@pytest.fixture
def build(tmp_path):
    made, title = prepared(target="prusaslicer")
    write_build(made, tmp_path / "job.build-1.3mf")
    return title


def run(path, text, *options):
    path.write_text(text, encoding="utf-8")
    return RUNNER.invoke(app, ["hook", "gcode", *options, str(path)])


def moved(points):
    return points + [9.0, 0.0]


def test_g_code_as_prepared_passes_and_gets_its_summary(build, tmp_path):
    ended = run(tmp_path / "a.gcode", Slicer().gcode(L_PRISMS, build), "--strict")
    assert (ended.exit_code, ended.stderr) == (0, "")
    assert "prints what was prepared" in ended.stdout
    assert "; amprep 0" in (tmp_path / "a.gcode").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "a.amprep.json").read_text(encoding="utf-8"))["ok"]


def test_strict_refuses_other_g_code_on_standard_error_and_writes_nothing(build, tmp_path):
    text = Slicer(change=moved).gcode(L_PRISMS, build)
    ended = run(tmp_path / "a.gcode", text, "--strict")
    assert ended.exit_code == 1
    assert "a.gcode does not print what was prepared" in ended.stderr
    assert "position: bracket: it is moved by (9, 0) mm" in ended.stderr
    (remedy,) = [line for line in ended.stderr.splitlines() if "remedy" in line]
    assert "neither arrange objects" in remedy
    assert (tmp_path / "a.gcode").read_text(encoding="utf-8") == text
    assert not (tmp_path / "a.amprep.json").exists()


def test_without_strict_faults_are_warnings(build, tmp_path):
    ended = run(tmp_path / "a.gcode", Slicer(change=moved).gcode(L_PRISMS, build))
    assert ended.exit_code == 0
    assert "it is moved by (9, 0) mm" in ended.stderr
    assert "; amprep fault: position: bracket" in (tmp_path / "a.gcode").read_text(encoding="utf-8")


@pytest.mark.parametrize(("options", "code"), [((), 0), (("--strict",), 1)])
def test_g_code_of_no_known_build_is_refused_only_by_strict(tmp_path, options, code):
    ended = run(tmp_path / "a.gcode", Slicer().gcode(L_PRISMS, "job 00000000"), *options)
    assert ended.exit_code == code
    assert "was not compared with a build" in ended.stderr


def test_json_goes_to_standard_output_alone(build, tmp_path):
    ended = run(tmp_path / "a.gcode", Slicer(change=moved).gcode(L_PRISMS, build), "--strict", "--json")
    values = json.loads(ended.stdout)
    assert (values["ok"], len(values["violations"])) == (False, 2)


def test_install_shows_the_settings_and_writes_only_if_asked_to(tmp_path):
    profile = tmp_path / "print" / "fine.ini"
    profile.parent.mkdir()
    profile.write_text("layer_height = 0.1\n", encoding="utf-8")
    words = ["hook", "install", "--slicer", "prusaslicer", "--profile", "fine", "--settings", str(tmp_path)]
    shown = RUNNER.invoke(app, words)
    assert "nothing was written" in shown.stdout
    assert profile.read_text(encoding="utf-8") == "layer_height = 0.1\n"
    written = RUNNER.invoke(app, [*words, "--write", "--strict"])
    assert written.exit_code == 0
    assert "hook gcode --strict" in profile.read_text(encoding="utf-8")
