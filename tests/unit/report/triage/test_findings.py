"""Everything that a run found is listed once, with its class, its part and its place."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.findings import overhang, run_of_overhangs

from amprep.checks.violation import Violation
from amprep.geometry.powder.pockets import Pocket
from amprep.geometry.removal.order import RemovalOrder
from amprep.measures.legs import BodyLegs, MeasuredLeg
from amprep.measures.removability import Removal
from amprep.report.record import BuildRecord, RunRecord, UnplacedRecord
from amprep.report.triage.findings import build_findings, findings_of

POCKET = Pocket(2.0, (5.0, 6.0, 1.0), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), True)


@pytest.fixture
def entry(make_build) -> BuildRecord:
    return BuildRecord(make_build())


def test_copies_of_a_part_have_the_name_of_the_part(entry):
    regions = tuple(overhang(name, part=name) for name in ("plate & <tray>", "plate & <tray>-2", "bar"))
    found = build_findings(replace(entry, overhangs=regions, build=replace(entry.build, unsupported=())))
    assert [each.part for each in found] == ["plate & <tray>", "plate & <tray>", "bar"]
    assert [each.name for each in found] == [region.name for region in regions]


def test_every_region_is_listed_once_with_its_verdict_and_its_centre(entry):
    regions = (overhang("a", kind="bore"), overhang("b", kind="tip", position=(1.0, 2.0, 3.0)))
    found = build_findings(replace(entry, overhangs=regions, build=replace(entry.build, unsupported=())), 4)
    assert [(each.kind, each.words, each.build) for each in found] == [
        ("bore", regions[0].verdict, 4),
        ("tip", regions[1].verdict, 4),
    ]
    assert found[1].position_mm == (1.0, 2.0, 3.0)
    np.testing.assert_array_equal(found[1].points, [[1.0, 2.0, 3.0]])


def test_the_marks_of_an_unsupported_region_are_its_points_without_support(entry):
    (region,) = entry.build.unsupported
    known = replace(entry, overhangs=(overhang(region.label, triage="must fix"),))
    (found,) = build_findings(known)
    np.testing.assert_array_equal(found.points, region.points)
    assert found.radius == region.radius


def test_an_unsupported_region_without_a_record_is_listed_nevertheless(entry):
    (found,) = build_findings(entry)
    assert (found.triage, found.part, found.words) == ("must fix", "plate & <tray>", "enclosed")
    minor = replace(entry.build.unsupported[0], minor=True)
    (found,) = build_findings(replace(entry, build=replace(entry.build, unsupported=(minor,))))
    assert found.triage == "worth a check"


def test_violations_must_be_fixed_and_powder_is_worth_a_check(entry):
    broken = Violation("clearance", "bar", "expected 0.5 mm, found 0.2 mm")
    removal = tuple(Removal(1.0, 2.0, 3.0, 4, (POCKET,), 0.1) for _ in entry.build.supports)
    found = build_findings(replace(entry, verification=(broken,), removal=removal))
    kinds = [(each.triage, each.kind, each.part) for each in found]
    assert ("must fix", "violation", "bar") in kinds
    assert kinds.count(("worth a check", "powder pocket", "plate & <tray>")) == 1
    assert kinds.count(("worth a check", "powder pocket", "bar")) == 1


def test_closed_cavities_are_worth_a_check_although_powder_was_not_measured(entry):
    removal = tuple(Removal(1.0, 2.0, cavities=(POCKET._replace(volume=0.03),)) for _ in entry.build.supports)
    found = [each for each in build_findings(replace(entry, removal=removal)) if each.kind == "powder pocket"]
    assert len(found) == len(entry.build.supports)
    assert found[0].words == "0.03 mm³ of powder cannot leave: no opening"
    assert found[0].triage == "worth a check"


def test_legs_that_are_too_long_are_worth_a_check(entry):
    leg = MeasuredLeg(12.0, 24.0, 2.0, (1.0, 2.0, 3.0))
    rules = replace(entry.build.settings.rules, leg_ratio=10.0)
    build = replace(entry.build, settings=replace(entry.build.settings, rules=rules), unsupported=())
    legs = (BodyLegs(4, leg, (leg,)), BodyLegs(1, None, ()))
    (found,) = build_findings(replace(entry, build=build, legs=legs))
    assert (found.triage, found.kind, found.position_mm) == ("worth a check", "long leg", (1.0, 2.0, 3.0))
    assert found.words == "24.0 mm long, 2.00 mm wide: 12.0 times as long as wide, limit 10"


def test_a_leg_that_the_judge_finds_is_listed_once_and_must_be_fixed(entry):
    leg = MeasuredLeg(12.0, 24.0, 2.0, (1.0, 2.0, 3.0))
    build = replace(entry.build, unsupported=())
    legs = (BodyLegs(4, leg, (leg, leg)), BodyLegs(1, leg, (leg,)))
    broken = tuple(
        Violation(promise, build.supports[0].name, "a leg of 24.0 mm; at (1, 2, 3) mm (2 such legs)")
        for promise in ("legs", "least wall")
    )
    found = build_findings(replace(entry, build=build, legs=legs, verification=broken))
    assert [(each.triage, each.kind) for each in found] == [
        ("must fix", "violation"),
        *[("must fix", "long leg")] * 2,
        ("worth a check", "long leg"),
    ]
    unmeasured = build_findings(replace(entry, build=build, verification=broken))
    assert [each.kind for each in unmeasured] == ["violation"] * 2


def test_a_violation_has_the_place_that_its_message_states(entry):
    message = "a face has 11 sample points over 3 mm from any contact, first at (128.55, -3, 14.5) mm"
    placed, without = (
        build_findings(replace(entry, verification=(Violation("coverage", "bar", words),)))[0]
        for words in (message, "the files differ")
    )
    assert placed.position_mm == (128.55, -3.0, 14.5)
    np.testing.assert_array_equal(placed.points, [placed.position_mm])
    assert without.position_mm is None
    assert len(without.points) == 0


@pytest.mark.parametrize(("rule", "expected"), [("forbid", "must fix"), ("warn", "worth a check")])
def test_locked_parts_must_be_fixed_only_if_the_job_forbids_them(entry, rule, expected):
    locked = replace(entry, removal_order=RemovalOrder(locked=((0, 1),)))
    run = RunRecord("job", "1", 0, "MK4", "generic", (locked,), settings={"packing": {"interlocking": rule}})
    assert [each.triage for each in findings_of(run) if each.kind == "locked parts"] == [expected]


def test_unplaced_copies_must_be_fixed_unless_the_job_fills_one_build():
    run = RunRecord("job", "1", 0, "MK4", "generic", unplaced=(UnplacedRecord("crane", 2, "too large"),))
    (found,) = findings_of(run)
    assert (found.triage, found.build, found.name) == ("must fix", 0, "crane (copy 2)")
    assert findings_of(replace(run, objective="fill")) == []


def test_a_run_has_findings_that_must_be_fixed_if_and_only_if_it_has_faults(make_build):
    for kinds in ((), ("supported",), ("worth a check", "self-supporting")):
        assert run_of_overhangs(kinds).faults == 0
        assert all(each.triage != "must fix" for each in findings_of(run_of_overhangs(kinds)))
    run = RunRecord("job", "1", 0, "MK4", "generic", (BuildRecord(make_build()),))
    assert run.faults == sum(each.triage == "must fix" for each in findings_of(run)) == 1
