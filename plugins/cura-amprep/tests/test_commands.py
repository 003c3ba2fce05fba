"""The commands of the plugin are accepted by amprep, and what it answers becomes an outcome for the user."""

import json
import os
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from cura_amprep.bed import bed_of
from cura_amprep.outcome import outcome_of
from cura_amprep.plate import models_on
from cura_amprep.preparing import Order, file_name, prepare
from cura_amprep.process import Ended, Process, environment, progress_of
from cura_amprep.settings import Settings, rows_of, run_arguments, settings_from
from stand_ins import Mesh, Node

SIZES = {"machine_width": 60, "machine_depth": 40, "machine_height": 50}


def program(tmp_path, code):
    """The path of a program that runs Python code."""
    path = tmp_path / "program"
    path.write_text(f"#!{sys.executable}\n{code}\n", encoding="utf-8")
    path.chmod(0o755)
    return str(path)


def order(tmp_path, code, **settings):
    bed = bed_of("Small & round", SIZES.get, margin=3.0)
    models = models_on(Node(children=[Node(Mesh((10, 5, 10)), name="plate")]), 0, bed.from_scene())
    chosen = Settings(program(tmp_path, code), folder=str(tmp_path / "out"), **settings)
    return Order(models, bed, chosen, "job")


posix = pytest.mark.skipif(os.name == "nt", reason="the programs of these tests are scripts")


@posix
def test_amprep_prepares_a_plate_on_the_bed_of_the_machine(tmp_path):
    steps = []
    code = "from amprep.cli import main\nmain()"
    asked = order(tmp_path, code, packer="extreme-points")
    outcome = prepare(asked, Process(), lambda *step: steps.append(step))
    assert outcome.is_good, outcome.text
    assert outcome.text == "1 part in 1 build, 5 mm high."
    assert outcome.builds == (tmp_path / "out" / "job.build-1.3mf",)
    assert outcome.report == tmp_path / "out" / "job.report.html"
    assert {"models", "start", "pack"} <= {stage for stage, _, _ in steps}
    report = json.loads((tmp_path / "out" / "job.report.json").read_text(encoding="utf-8"))
    (build,) = report["builds"]
    assert report["printer"] == "Small & round"
    np.testing.assert_allclose(build["build_volume_mm"], (60, 40, 50))
    # the border of 3 mm that Cura keeps free for the brim
    assert min(build["parts"][0]["low_mm"][:2]) >= 3.0


def test_choices_that_are_empty_are_left_to_amprep():
    command = run_arguments(Settings(cell="x-wall"), "plate.3mf", "out", "job", "EOS M290")
    assert command[:3] == ["amprep", "run", "plate.3mf"]
    assert command[command.index("--cell") + 1] == "x-wall"
    assert "--packer" not in command
    assert "--material" not in command


def test_settings_come_from_the_preferences_and_fill_the_dialog():
    settings = settings_from({"amprep/printer": " EOS M290 ", "amprep/program": ""}.get)
    assert settings == Settings(printer="EOS M290")
    rows = {row["key"]: row for row in rows_of(settings)}
    assert rows["printer"]["value"] == "EOS M290"
    assert all(row["label"] and row["hint"] for row in rows.values())


@posix
def test_an_error_of_amprep_is_the_text_for_the_user(tmp_path):
    code = "import sys\nsys.stderr.write('amprep: part \"plate\": does not fit\\n')\nsys.exit(2)"
    outcome = prepare(order(tmp_path, code, printer="EOS M290"), Process(), lambda *_: None)
    assert outcome.text == 'amprep: part "plate": does not fit'
    assert outcome.builds == ()


def test_a_program_that_is_missing_is_named(tmp_path):
    ended = Process().run([str(tmp_path / "missing")], lambda *_: None)
    assert ended.code is None
    assert "missing does not start: " in outcome_of(ended, tmp_path).text


@posix
def test_cancelling_ends_the_program_and_starts_no_other(tmp_path):
    code = (
        "import json, sys, time\n"
        "sys.stderr.write(json.dumps({'stage': 'pack', 'fraction': 0.5, 'message': ''}) + '\\n')\n"
        "sys.stderr.flush()\ntime.sleep(60)"
    )
    process, path = Process(), program(tmp_path, code)
    ended = process.run([path], lambda *_: threading.Thread(target=process.cancel).start())
    assert ended.cancelled
    assert ended.code != 0
    assert outcome_of(ended, tmp_path).is_cancelled
    assert process.run([path], lambda *_: None) == Ended(None, cancelled=True)


def test_cancelling_when_the_files_are_there_changes_nothing(tmp_path):
    builds = [{"file": "job.build-1.3mf", "parts": [{}], "height_mm": 4.0}]
    report = {"job": "job", "builds": builds, "unplaced": [], "triage": {"must_fix": 0}}
    outcome = outcome_of(Ended(0, json.dumps(report), cancelled=True), tmp_path)
    assert not outcome.is_cancelled
    assert outcome.builds == (tmp_path / "job.build-1.3mf",)


@pytest.mark.parametrize(
    "line", ["", "amprep: wrong", "{", "{}", '{"stage": "pack", "fraction": "x", "message": ""}']
)
def test_other_lines_are_no_progress(line):
    assert progress_of(line) is None


def test_a_line_of_progress_has_stage_fraction_and_message():
    assert progress_of('{"stage": "pack", "fraction": 0.25, "message": "box 3"}\n') == ("pack", 0.25, "box 3")


@pytest.mark.parametrize("output", ["", "[]", "{}", '{"builds": 3}', '{"builds": [{}]}'])
def test_an_answer_that_is_no_report_is_said(output, tmp_path):
    outcome = outcome_of(Ended(0, output), tmp_path)
    assert "no report" in outcome.text
    assert not outcome.is_good


def test_what_is_not_placed_or_must_be_fixed_is_said_and_files_stay_in_the_folder(tmp_path):
    report = {
        "job": "../job",
        "builds": [{"file": "../../etc/passwd", "parts": [{}], "height_mm": 4.4}] * 2,
        "unplaced": [{}],
        "triage": {"must_fix": 2},
    }
    outcome = outcome_of(Ended(1, json.dumps(report)), tmp_path)
    assert outcome.builds == (tmp_path / "passwd",) * 2
    assert outcome.report is None
    assert outcome.text.startswith("2 parts in 2 builds, 4 mm high. 1 part not placed. 2 findings")


def test_another_python_gets_nothing_of_the_one_in_cura():
    own = {"PYTHONHOME": "/cura", "LD_LIBRARY_PATH": "/cura/lib", "HOME": "/home/me"}
    assert environment(own) == {"HOME": "/home/me", "PYTHONUTF8": "1"}


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("UM3 plate/1", "UM3 plate-1"),
        ("..", "plate"),
        ("a" * 200, "a" * 80),
        ("Größe", "Größe"),
        ("", "plate"),
    ],
)
def test_a_name_of_a_job_is_a_name_of_a_file(name, kept):
    assert file_name(name) == kept


def test_the_folder_is_in_the_home_folder_unless_the_user_chooses(tmp_path):
    bed = bed_of("machine", SIZES.get)
    assert Order([], bed, Settings(), "job").folder == Path.home() / "amprep"
    assert Order([], bed, Settings(folder=str(tmp_path)), "job").folder == tmp_path
