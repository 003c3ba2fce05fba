"""Figures of runs side by side, from made reports."""

import json

import pytest

from amprep.errors import InputError
from amprep.report.comparison.page import comparison_text
from amprep.report.comparison.read import ComparedRun, read_runs
from amprep.report.comparison.rows import figures_of, findings_in_some

EVIL = "</td><script>alert(1)</script>"


def report(packer="auto", height=40.0, findings=(), job="job", **more):
    build = {
        "height_mm": height,
        "parts": [{}, {}],
        "printing": {"hours": 5.0, "plate_use": 0.25},
        "supports": {},
    }
    return {
        "format": 2,
        "job": job,
        "status": "optimal",
        "triage": {"must_fix": len(findings), "worth_a_check": 0},
        "findings": [{"triage": "must fix", "part": part, "message": words} for part, words in findings],
        "builds": [build],
        "unplaced": [],
        "stages": [{"name": "pack", "seconds": 2.0}],
        "settings": {"packing": {"strategy": packer}},
    } | more


def runs(*reports, tmp_path):
    paths = []
    for number, each in enumerate(reports):
        folder = tmp_path / f"folder {number}"
        folder.mkdir()
        paths.append(folder / "job.report.json")
        paths[-1].write_text(json.dumps(each))
    return read_runs(paths)


def row(found, title):
    (figure,) = (each for each in found if each.title == title)
    return figure


def test_the_least_height_is_the_best_and_differences_are_to_the_first_run(tmp_path):
    found = figures_of(runs(report("auto", 40.0), report("annealing", 30.0), tmp_path=tmp_path))
    height = row(found, "Height, all builds")
    assert height.best == (False, True)
    assert height.words() == ["40.0 mm", "30.0 mm (-25.0 %)"]
    assert row(found, "Parts placed").best == (False, False)
    assert row(found, "Packer").words() == ["auto", "annealing"]


def test_of_values_that_look_equal_none_is_the_best(tmp_path):
    height = row(
        figures_of(runs(report("auto", 40.01), report("x", 40.02), tmp_path=tmp_path)), "Height, all builds"
    )
    assert height.words() == ["40.0 mm", "40.0 mm"]
    assert height.best == (False, False)


def test_a_figure_that_one_build_lacks_is_unknown_and_one_that_all_lack_is_left_out(tmp_path):
    lacking = report()
    del lacking["builds"][0]["printing"]["hours"]
    found = figures_of(runs(lacking, report(), tmp_path=tmp_path))
    assert row(found, "Printing time").words() == ["unknown", "5.0 h"]
    assert "Mass of parts" not in {each.title for each in found}


@pytest.mark.parametrize(
    ("one", "other", "names"),
    [
        (report(job="a"), report(job="b"), ["a", "b"]),
        (report("auto"), report("annealing"), ["auto", "annealing"]),
        (report(), report(), ["folder 0", "folder 1"]),
    ],
)
def test_runs_are_named_after_what_differs(one, other, names, tmp_path):
    assert [run.name for run in runs(one, other, tmp_path=tmp_path)] == names


def test_only_what_must_be_fixed_in_some_runs_is_listed(tmp_path):
    both, one = ("a", "ledge"), ("b", "bridge")
    (found,) = findings_in_some(
        runs(report(findings=[both, one]), report("x", findings=[both]), tmp_path=tmp_path)
    )
    assert found == ("b", "bridge", (1, 0))


def test_the_page_escapes_names_and_holds_pictures_of_the_folder_only(tmp_path):
    picture = tmp_path / "folder 0" / "a.png"
    first = report(EVIL, findings=[(EVIL, EVIL)])
    first["builds"][0]["picture"] = "a.png"
    second = report("auto")
    second["builds"][0]["picture"] = "../folder 0/a.png"
    found = runs(first, second, tmp_path=tmp_path)
    picture.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(10))
    text = comparison_text(found)
    assert "<script" not in text
    assert text.count("data:image/png") == 1
    assert ComparedRun("x", tmp_path, second).picture(second["builds"][0]) == ""


def test_findings_are_counted_and_a_page_without_any_says_so(tmp_path):
    unplaced = ("a", "no room left")
    found = runs(report(findings=[unplaced] * 5), report("x", findings=[unplaced]), tmp_path=tmp_path)
    assert findings_in_some(found) == [("a", "no room left", (5, 1))]
    assert "the same in all runs" not in comparison_text(found)


def test_nothing_to_fix_is_said(tmp_path):
    assert "Nothing must be fixed." in comparison_text(runs(report(), report("x"), tmp_path=tmp_path))


@pytest.mark.parametrize("height", [10**400, float("nan"), True, "40"])
def test_numbers_that_are_none_are_unknown(height, tmp_path):
    (run, _) = runs(report(height=height), report("x"), tmp_path=tmp_path)
    assert "Height, all builds" not in {each.title for each in figures_of([run])}


def test_texts_cannot_command_the_terminal_and_long_names_are_no_picture(tmp_path):
    first = report("\x1b[2Jred \ud800")
    first["builds"][0]["picture"] = "a" * 5000
    found = runs(first, report("x"), tmp_path=tmp_path)
    assert found[0].name == " [2Jred  "
    assert comparison_text(found)


@pytest.mark.parametrize("text", ["", "[]", "{", '{"builds": []}', json.dumps(report(format=1)), "nan"])
def test_a_file_that_is_no_report_is_refused_by_name(text, tmp_path):
    path = tmp_path / "a.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"a\.json: "):
        read_runs([path])


@pytest.mark.parametrize("broken", [{"builds": [3, None]}, {"findings": 4}, {"stages": {}}, {"settings": []}])
def test_a_damaged_report_shows_what_it_has(broken, tmp_path):
    found = runs(report() | broken, report("x"), tmp_path=tmp_path)
    assert comparison_text(found)
