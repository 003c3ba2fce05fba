"""The judges of limits work together, and say what they judged."""

from dataclasses import replace

from tests.shared.supported import box, build_of, table

from amprep.checks.supports.limits import NOT_JUDGED, PROMISES, check_limits
from amprep.model import Stop
from amprep.model.supports.sizes import SupportSizes

ALL = {
    "rules": "limits",
    "ledge_mm": 1.0,
    "bridge_mm": 2.0,
    "bore_mm": 8.0,
    "least_wall_mm": 0.3,
    "least_contact_mm2": 0.09,
    "leg_ratio": 10.0,
    "territory": "own",
    "territory_margin_mm": 0.5,
    "drift_ratio": 0.3,
    "drift_mm": 15.0,
}
SIZES = SupportSizes(square_mm=1.0)


def judged(body, height=8.0, **rules):
    return check_limits(build_of([table(height)], [body], SIZES, **rules), Stop())


def test_a_stout_column_below_its_table_breaks_nothing():
    result = judged(box((2, 2, 8.1), (5, 5, 0)), **ALL)
    assert result.violations == []
    assert not any(text.startswith(NOT_JUDGED) for text in result.extent.values())
    assert "section" in result.extent["least wall"]


def test_each_fault_breaks_its_own_promise():
    faults = {
        "least wall": box((0.2, 3, 2.1), (5, 5, 0)),
        "least contact": box((0.31, 0.31, 2.1), (5, 5, 0)),
        "legs": box((2, 2, 60), (5, 5, 0)),
        "own territory": box((2, 2, 8), (19.5, 5, 0)),
        "drift": box((2, 2, 8), (40, 5, 0)),
    }
    assert set(faults) == set(PROMISES)
    for promise, body in faults.items():
        height = 60.0 if promise == "legs" else 8.0
        rules = ALL | ({"least_contact_mm2": 0.2} if promise == "least contact" else {})
        assert promise in {each.promise for each in judged(body, height, **rules).violations}


def test_rules_of_the_thesis_ask_for_none_of_them():
    result = judged(box((0.05, 0.05, 60), (40, 5, 0)), 60.0)
    assert result.violations == []
    assert {promise for promise, text in result.extent.items() if text.startswith(NOT_JUDGED)} == set(
        PROMISES
    )
    assert result.extent["coverage"] == "all overhangs flatter than 45 degrees, points at most 1 mm apart"


def test_a_job_without_supports_says_that_coverage_is_not_judged():
    build = build_of([table(8)], [])
    alone = replace(build, settings=replace(build.settings, supported=False))
    assert check_limits(alone, Stop()).extent["coverage"].startswith(NOT_JUDGED)


def test_a_stopped_run_judges_no_more():
    stop = Stop()
    stop.cancelled.set()
    build = build_of([table(8)], [box((0.1, 0.1, 8), (40, 5, 0))], SIZES, **ALL)
    assert check_limits(build, stop).violations == []
