"""The class of a region follows from its verdict and from what of it has no support."""

from typing import get_args

import numpy as np
import pytest

from amprep.geometry.overhangs.regions import Kind, OverhangRegion
from amprep.model import Unsupported
from amprep.model.supports import EXCEPTED
from amprep.report.triage.classes import NEAR_LIMIT, TRIAGES, triage_of

KINDS = get_args(Kind)


def region(kind="ledge", **fields) -> OverhangRegion:
    return OverhangRegion(kind, 0.0 if kind == "tip" else 10.0, np.zeros(3), **fields)


def left(measure=10.0, *, minor=False, reason="enclosed") -> Unsupported:
    return Unsupported(0, "overhang 1 of bar", "ledge", reason, measure, np.zeros((1, 3)), 1.0, minor)


@pytest.mark.parametrize("kind", KINDS)
def test_a_region_without_support_must_be_fixed_whatever_its_kind(kind):
    found = triage_of(
        region(kind, starts_in_air=kind != "bore"), [left(0.0 if kind == "tip" else 10.0)], 45.0
    )
    assert found == ("must fix", "not", "enclosed")


@pytest.mark.parametrize("kind", KINDS)
def test_a_region_that_supports_carry_is_supported(kind):
    assert triage_of(region(kind, size_mm=6.0, limit_mm=1.0), [], 45.0) == ("supported", "fully", "")


@pytest.mark.parametrize("kind", KINDS)
def test_a_region_that_the_part_carries_is_self_supporting(kind):
    assert triage_of(region(kind, is_self_supporting=True), [], 45.0) == ("self-supporting", "not needed", "")


def test_a_region_with_one_fault_and_one_minor_patch_must_be_fixed_for_the_reason_of_the_fault():
    found = triage_of(region(), [left(4.0), left(1.0, minor=True, reason="capacity")], 45.0)
    assert found == ("must fix", "partly", "enclosed")


def test_minor_patches_alone_are_worth_a_check():
    found = triage_of(region(), [left(0.2, minor=True)], 45.0)
    assert (found.triage, found.outcome) == ("worth a check", "fully")


@pytest.mark.parametrize(
    ("size", "expected"), [(0.89, "self-supporting"), (0.9, "worth a check"), (1.0, "worth a check")]
)
def test_a_self_supporting_region_near_its_limit_is_worth_a_check(size, expected):
    assert NEAR_LIMIT == 0.9
    found = triage_of(region("bore", is_self_supporting=True, size_mm=8.0 * size, limit_mm=8.0), [], 45.0)
    assert found.triage == expected


def test_chamfers_at_the_overhang_angle_are_near_no_limit():
    chamfer = region(is_self_supporting=True, size_mm=0.95, limit_mm=1.0, angle_deg=44.9)
    assert triage_of(chamfer, [], 45.0).triage == "self-supporting"
    assert triage_of(chamfer._replace(angle_deg=42.0), [], 45.0).triage == "worth a check"
    assert triage_of(chamfer._replace(kind="edge"), [], 45.0).triage == "worth a check"


def test_a_region_above_its_limit_that_is_supported_needs_no_check():
    assert triage_of(region(size_mm=1.01, limit_mm=1.0), [], 45.0).triage == "supported"


def test_faces_that_are_not_critical_are_worth_a_check():
    steep = region("face", is_self_supporting=True, is_noncritical=True, angle_deg=47.0)
    assert triage_of(steep, [], 45.0).triage == "worth a check"


def test_a_region_that_a_rule_leaves_without_supports_is_worth_a_check():
    found = triage_of(region("bore"), [left(minor=True, reason=EXCEPTED)], 45.0)
    assert found == ("worth a check", "not", "a rule of the job leaves it without supports")


def test_the_classes_are_listed_from_the_most_urgent_to_the_least():
    assert TRIAGES == ("must fix", "worth a check", "supported", "self-supporting")
