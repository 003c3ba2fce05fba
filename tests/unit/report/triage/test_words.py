"""Findings in words have their name, what was found, and their place."""

import numpy as np
import pytest
from tests.shared.findings import overhang, run_of

from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.report.triage.classes import RegionTriage
from amprep.report.triage.findings import Finding, findings_of
from amprep.report.triage.words import finding_words, position_words, region_words

LEDGE = OverhangRegion("ledge", 9.0, np.zeros(3), 6.0, 1.0)
BORE = OverhangRegion("bore", 9.0, np.zeros(3), 3.9, 4.0, is_self_supporting=True)


@pytest.mark.parametrize(
    ("region", "found", "words"),
    [
        (LEDGE, RegionTriage("supported", "fully"), "ledge 6.0 mm over 1.0: supported"),
        (
            LEDGE,
            RegionTriage("must fix", "not", "enclosed"),
            "ledge 6.0 mm over 1.0: not supported, enclosed",
        ),
        (BORE, RegionTriage("self-supporting", "not needed"), "self-supporting: bore 3.9 mm"),
        (
            BORE,
            RegionTriage("worth a check", "not needed", "near the limit of 4 mm"),
            "self-supporting: bore 3.9 mm, near the limit of 4 mm",
        ),
    ],
)
def test_a_verdict_says_what_carries_the_region_and_why_it_is_not_in_order(region, found, words):
    assert region_words(region, found) == words


def test_a_region_is_named_and_has_its_position():
    (found,) = findings_of(run_of([overhang("overhang 7 of bracket-2", position=(31.24, -0.01, 12.0))]))
    assert finding_words(found) == f"overhang 7 of bracket-2: {found.words}, at (31.2, 0.0, 12.0) mm"


def test_another_finding_has_its_kind_and_only_a_place_that_is_known():
    lost = Finding("must fix", 0, "crane", "unplaced copy", "crane (copy 2)", "too large")
    assert finding_words(lost) == "unplaced copy: crane (copy 2): too large"
    assert position_words(lost) == ""
