"""Verification judges the limits that a build's file records, and says to which tolerance."""

from dataclasses import replace

import pytest
from tests.shared.supported import box, build_of, table

from amprep import workers
from amprep.checks.supports.limits import NOT_JUDGED, PROMISES
from amprep.model import Stop
from amprep.model.supports.sizes import SupportSizes
from amprep.pipeline.verifying.build import PROMISES as ALL_PROMISES
from amprep.pipeline.verifying.build import verify_build
from amprep.pipeline.verifying.file import verify_file
from amprep.threemf import write_build

LIMITS = {"rules": "limits", "ledge_mm": 1.0, "bridge_mm": 2.0, "bore_mm": 8.0}
SIZES = SupportSizes(square_mm=2.0, tip_width_mm=0.5, neck_mm=0.25)


def ledge_build(length, supported, **rules):
    """A block with a shelf of a length, and a wall below its outer border."""
    part = box((10, 10, 20), (0, 0, 0)) + box((10 + length, 10, 5), (0, 0, 10))
    wall = box((max(length - 0.5, 0.5), 10, 10.05), (10.4, 0, 0))
    build = build_of([part], [wall] if supported else [], SIZES, **(LIMITS | rules))
    return replace(build, settings=replace(build.settings, reach=0.3))


@pytest.mark.parametrize(("length", "broken"), [(0.9, False), (1.3, True), (6.0, True)])
def test_a_support_removed_below_a_ledge_breaks_coverage_beyond_the_limit(length, broken):
    promises = {each.promise for each in verify_build(ledge_build(length, supported=False)).violations}
    assert ("coverage" in promises) == broken
    assert "coverage" not in {
        each.promise for each in verify_build(ledge_build(length, supported=True)).violations
    }


def test_a_file_keeps_the_rules_and_sizes_that_judges_need(tmp_path):
    build = ledge_build(3.0, supported=True, least_wall_mm=0.3, leg_ratio=10.0)
    write_build(build, tmp_path / "a.3mf")
    judged = verify_file(tmp_path / "a.3mf")
    assert "0.3 mm, tolerance 0.03 mm" in judged.extent["least wall"]
    covered = "ledges 1, bridges 2, bores 8 mm are carried, tolerance 0.08 mm, points at most 0.1 mm apart"
    assert judged.extent["coverage"] == covered


def test_builds_by_the_rules_of_the_thesis_are_judged_by_none_of_the_limits(tmp_path):
    tables = [table(10), table(10, corner=(50, 0))]
    thin = build_of(tables, [box((20, 20, 10.1), (0, 0, 0)), box((0.05, 0.05, 10.05), (52, 5, 0))])
    write_build(thin, tmp_path / "a.3mf")
    judged = verify_file(tmp_path / "a.3mf")
    assert {each.promise for each in judged.violations} == {"coverage"}
    assert all(judged.extent[promise].startswith(NOT_JUDGED) for promise in PROMISES)


def test_every_promise_says_what_was_judged(tmp_path):
    write_build(ledge_build(3.0, supported=True), tmp_path / "a.3mf")
    judged = verify_file(tmp_path / "a.3mf")
    assert set(judged.extent) == set(ALL_PROMISES)
    assert all(judged.extent.values())
    assert judged.extent["inside build volume"] == "exact on the triangles, tolerance 0.0011 mm: 1 part"
    assert judged.extent["outside forbidden zones"] == f"{NOT_JUDGED}: no zones"


def test_removability_is_judged_when_it_is_asked_for(tmp_path):
    hollow = box((20, 20, 10.05), (0, 0, 0)) - box((10, 10, 5), (5, 5, 2))
    build = build_of([table(10)], [hollow])
    assert "powder can leave" not in {each.promise for each in verify_build(build).violations}
    found = verify_build(build, removability=True)
    (powder,) = (each for each in found.violations if each.promise == "powder can leave")
    assert "1 pocket" in powder.message
    assert "0.2 mm" in found.extent["powder can leave"]


def test_two_processes_judge_as_one_does(monkeypatch):
    monkeypatch.setattr(workers, "_WORTH_IT", 0.0)
    build = build_of([table(10), table(10, corner=(8, 0))], [box((0.05, 0.05, 10.05), (2, 5, 0))])
    alone = verify_build(build)
    with workers.allowed(2):
        together = verify_build(build)
    assert {each.promise for each in alone.violations} > {"no intersection"}
    assert (together.violations, together.pairs, together.extent) == (
        alone.violations,
        alone.pairs,
        alone.extent,
    )


def test_what_was_not_judged_before_the_deadline_counts_as_broken():
    build = ledge_build(3.0, supported=True)
    late = verify_build(build, stop=Stop.after(0.0))
    of_other_judges = {"printed as planned", "powder can leave", "contacts can be reached"}
    assert {each.promise for each in late.violations} == set(ALL_PROMISES) - of_other_judges
    assert all("not judged to the end" in each.message for each in late.violations)
    assert verify_build(build, stop=Stop.after(1000.0)).ok
