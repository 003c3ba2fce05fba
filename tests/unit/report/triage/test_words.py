"""Findings in words have their name, what was found, and their place."""

import pytest
from tests.shared.findings import overhang, run_of

from amprep.report.triage.classes import RegionTriage
from amprep.report.triage.findings import Finding, findings_of
from amprep.report.triage.words import finding_words, position_words, region_words


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (RegionTriage("supported", "fully"), "ledge 6.0 mm over 1.0: supported"),
        (RegionTriage("self-supporting", "not needed"), "ledge 6.0 mm over 1.0"),
        (
            RegionTriage("must fix", "not", "not supported: enclosed"),
            "ledge 6.0 mm over 1.0; not supported: enclosed",
        ),
    ],
)
def test_a_verdict_is_followed_by_what_was_done_about_the_region(found, words):
    assert region_words("ledge 6.0 mm over 1.0", found) == words


def test_a_region_is_named_and_has_its_position():
    (found,) = findings_of(run_of([overhang("overhang 7 of bracket-2", position=(31.24, -0.01, 12.0))]))
    assert finding_words(found) == f"overhang 7 of bracket-2: {found.words}, at (31.2, 0.0, 12.0) mm"


def test_another_finding_has_its_kind_and_only_a_place_that_is_known():
    lost = Finding("must fix", 0, "crane", "unplaced copy", "crane (copy 2)", "too large")
    assert finding_words(lost) == "unplaced copy: crane (copy 2): too large"
    assert position_words(lost) == ""
