"""The JSON report and the summary for the terminal contain the results of a run."""

import json
from dataclasses import replace
from io import StringIO
from math import inf, nan, pi
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from amprep.checks.violation import Violation
from amprep.files import replacing
from amprep.measures.density import build_density, build_height, support_volume
from amprep.model import Build, BuildSettings, BuildVolume
from amprep.report.json_report import to_json, write_json
from amprep.report.json_values import json_text
from amprep.report.page.html import html_text
from amprep.report.record import BuildRecord, RunRecord, StageTime, UnconnectedSquare, UnplacedRecord
from amprep.report.terminal import MOST_LINES, summary


@pytest.fixture
def record(make_build) -> RunRecord:
    """Return a run with one of everything: unplaced, unsupported, unconnected, a violation."""
    lost = UnconnectedSquare("bar", "overhang 1 of bar", "enclosed", (4, 2, 1), (1.5, 2.5, 6.0))
    broken = Violation("clearance", "bar", "expected 0.5 mm, found 0.2 mm")
    entry = BuildRecord(
        make_build(), "job.build-1.3mf", "job.build-1.png", 0.25, 5.0, 48.4, 7, (lost,), (broken,)
    )
    return RunRecord(
        "job",
        "0.1.0",
        3,
        "MK4",
        "generic",
        (entry,),
        unplaced=(UnplacedRecord("crane", 2, "too large"),),
        stages=(StageTime("read", 0.25), StageTime("pack", 1.5)),
        bound=1.0,
        warnings=("plugin x 1.0 was not loaded",),
        settings={"packing": {"clearance_mm": 0.5, "limit": inf, "size": np.array([1.0, nan])}},
    )


def printed(record: RunRecord) -> str:
    console = Console(width=90, record=True, file=StringIO())
    console.print(summary(record))
    return console.export_text()


def test_the_json_report_contains_the_results_of_the_run(record):
    report = json.loads(json_text(to_json(record)))
    build = report["builds"][0]
    assert {"file", "parts", "density", "height_mm", "supports"} <= build.keys()
    assert {"volume_mm3", "demand_squares", "unconnected_squares"} <= build["supports"].keys()
    assert {"builds", "unplaced", "stages", "seed", "status", "stop_reason", "bound"} <= report.keys()
    assert report["found_by"] is None
    assert report["stages"] == [{"name": "read", "seconds": 0.25}, {"name": "pack", "seconds": 1.5}]
    assert report["unplaced"] == [{"name": "crane", "copy": 2, "reason": "too large", "value": None}]
    assert build["supports"]["unconnected_squares"][0]["reason"] == "enclosed"
    assert build["violations"][0]["promise"] == "clearance"


def test_transforms_are_4_by_4_row_major_in_mm(record):
    for placed, part in zip(record.builds[0].build.parts, to_json(record)["builds"][0]["parts"], strict=True):
        assert part["name"] == placed.label
        np.testing.assert_array_equal(part["transform"], placed.matrix)
        assert part["transform"][3] == [0.0, 0.0, 0.0, 1.0]
        np.testing.assert_allclose(part["low_mm"], placed.mesh.bounds[0])


def test_numbers_that_are_not_finite_become_null(record):
    text = json_text(to_json(replace(record, bound=inf)))
    report = json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))
    assert report["bound"] is None
    assert report["settings"]["packing"] == {"clearance_mm": 0.5, "limit": None, "size": [1.0, None]}


def test_the_same_record_gives_the_same_text_with_unchanged_names(record):
    odd = replace(record, job='a "name" [\n1, 2\n] \\ ü \udc80')
    assert json_text(to_json(odd)) == json_text(to_json(odd))
    assert json.loads(json_text(to_json(odd)))["job"] == odd.job


def test_a_name_with_invalid_unicode_is_written(record, tmp_path):
    path = tmp_path / "job.report.json"
    write_json(replace(record, job="\udc80"), path)
    assert json.loads(path.read_bytes())["job"] == "\udc80"
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_an_interrupted_write_leaves_the_old_file_and_no_other(tmp_path):
    path = tmp_path / "report.json"
    path.write_text("old")

    def interrupted() -> None:
        with replacing(path) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text(encoding="utf-8") == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.json"]


def test_measures_count_solids_once_and_ignore_surfaces(make_build):
    build = make_build()
    # highest is the bar: lowest point 0.3, 9 high, 3 mm above the plate
    assert build_height(build) == pytest.approx(12.3, abs=1e-5)
    assert build_density(build) == pytest.approx((800 + 504 + 800) / (250 * 210 * 12.3), rel=1e-5)
    assert support_volume(build) == pytest.approx(2 * 2 * 3 + 2 * 2 * 3.3, rel=1e-5)
    assert support_volume(make_build(surface=True)) == pytest.approx(2 * 2 * 3.3, rel=1e-5)


def test_the_density_of_a_cylinder_refers_to_its_disc(make_build):
    build = make_build()
    space = BuildVolume((300, 300, 220), "cylinder")
    round_build = replace(build, settings=replace(build.settings, space=space))
    assert build_density(round_build) == pytest.approx(2104 / (pi / 4 * 300**2 * 12.3), rel=1e-5)


def test_an_empty_build_has_no_height_and_no_density():
    empty = Build(BuildSettings("none", BuildVolume((10, 10, 10))), ())
    assert (build_height(empty), build_density(empty), support_volume(empty)) == (0.0, 0.0, 0.0)


def test_unplaced_copies_are_a_fault_unless_the_job_fills_one_build(record):
    # an unsupported region, a violation, an unplaced copy
    assert record.faults == 3
    assert replace(record, objective="fill").faults == 2


def test_the_summary_shows_figures_issues_durations_and_files(record):
    text = printed(record)
    for words in ("25.0 %", "5.0 mm", "0.05 cm³", "12.5 mm²", "no (1)", "3 parts in 1 build, 1 unplaced"):
        assert words in text
    for words in (
        "crane (copy 2): too large",
        "must fix: overhang 1 of plate-2: enclosed, at (2.6, 3.5, 4.5) mm",
        "read 0.2",
        "job.build-1.3mf",
    ):
        assert words in text


def test_names_from_files_cannot_control_the_terminal_or_the_markup(record):
    evil = replace(
        record, job="[red]x[/red]\x1b[2J", unplaced=(UnplacedRecord("[b]y\x1b]0;t\x07", 1, "[/]"),)
    )
    text = printed(evil)
    assert "\x1b" not in text
    assert "[red]x[/red]" in text
    assert "[b]y" in text


def test_a_record_prints_its_counts_in_one_line(record):
    assert str(record).startswith("job on MK4: ")
    assert str(record).endswith(f"in 1 build, 1 unplaced, {record.faults} faults")


def test_long_lists_are_shortened_in_the_terminal(record):
    many = tuple(UnplacedRecord("peg", copy, "no room left") for copy in range(1, 101))
    text = printed(replace(record, unplaced=many))
    assert text.count("\n!") <= MOST_LINES
    assert "more in the report" in text


def test_the_terminal_names_the_reports_and_the_folder_of_every_file(record):
    record = replace(record, report_files=("job.report.html", "job.report.json"))
    console = Console(width=90, record=True, file=StringIO())
    console.print(summary(record, Path("out")))
    text = console.export_text()
    written = [line.split()[1] for line in text.splitlines() if line.startswith("wrote")]
    assert written == [
        f"out/job.{name}" for name in ("report.html", "report.json", "build-1.3mf", "build-1.png")
    ]


def test_terminal_json_and_page_state_the_settings_that_follow_from_the_printer(record):
    words = "lift 3 mm and part distance 5 mm by default for metal powder beds"
    record = replace(record, by_default=(words,))
    assert to_json(record)["by_default"] == [words]
    assert words in printed(record)
    assert words in html_text(record)
