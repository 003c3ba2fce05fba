"""Findings of one class, part and kind are one group, and no finding is lost or counted twice."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.findings import overhang, run_of

from amprep.report.triage.classes import TRIAGES
from amprep.report.triage.findings import Finding, findings_of
from amprep.report.triage.groups import count_by_triage, counts_in_words, grouped

REGIONS = st.builds(
    lambda name, triage, kind, part, size: overhang(name, triage, kind=kind, part=part, size=size),
    st.text(max_size=5),
    st.sampled_from(TRIAGES),
    st.sampled_from(["ledge", "bridge", "bore", "flat", "edge", "tip", "face"]),
    st.sampled_from(["bracket", "wheel", ""]),
    st.floats(0.0, 20.0),
)


@examples(50)
@given(st.lists(REGIONS, max_size=30))
def test_groups_hold_each_finding_once_and_differ_in_class_part_or_kind(regions):
    findings = findings_of(run_of(regions))
    groups = grouped(findings)
    assert Counter(id(each) for group in groups for each in group.findings) == Counter(map(id, findings))
    keys = [(group.triage, group.part, group.kind) for group in groups]
    assert len(set(keys)) == len(keys)
    for group in groups:
        assert {(each.triage, each.part, each.kind) for each in group.findings} == {
            (group.triage, group.part, group.kind)
        }


@examples(50)
@given(st.lists(REGIONS, max_size=30))
def test_urgent_groups_come_first_and_large_regions_first_in_a_group(regions):
    groups = grouped(findings_of(run_of(regions)))
    order = [TRIAGES.index(group.triage) for group in groups]
    assert order == sorted(order)
    for group in groups:
        sizes = [each.overhang.region.size_mm for each in group.findings if each.overhang]
        assert sizes == sorted(sizes, reverse=True)


def test_a_region_that_starts_in_the_air_is_before_larger_ones():
    low = overhang("low", "must fix", measure=1.0)
    low = low.__class__(**{**vars(low), "region": low.region._replace(starts_in_air=True)})
    (group,) = grouped(findings_of(run_of([overhang("large", "must fix", size=9.0), low])))
    assert [each.name for each in group.findings] == ["low", "large"]


@pytest.mark.parametrize(
    ("kind", "sizes", "limit", "words"),
    [
        ("bore", [3.0, 4.2, 3.5], 8.0, "3 bores 3.0 to 4.2 mm, limit 8 mm"),
        ("ledge", [6.0], 1.0, "1 ledge 6.0 mm, limit 1 mm"),
        ("bridge", [2.0, 2.01], 0.0, "2 bridges 2.0 mm"),
        ("edge", [0.0, 0.0], 0.0, "2 knife edges 1.0 mm long"),
        ("flat", [0.0], 0.0, "1 flat 1.0 mm²"),
    ],
)
def test_the_words_of_a_group_state_count_sizes_and_limit(kind, sizes, limit, words):
    regions = [overhang(f"{k}", kind=kind, size=size, limit=limit) for k, size in enumerate(sizes)]
    (group,) = grouped(findings_of(run_of(regions)))
    assert group.words == words


def test_tips_and_other_findings_have_no_size():
    tip = grouped(findings_of(run_of([overhang("t", kind="tip", measure=0.0)])))[0]
    assert tip.words == "1 tip"
    lost = Finding("must fix", 0, "crane", "unplaced copy", "crane (copy 1)", "too large")
    assert [group.words for group in grouped([lost, lost])] == ["2 unplaced copies"]
    assert [group.words for group in grouped([lost])] == ["too large"]


def test_violations_name_the_promises_that_are_broken():
    words = ("coverage: one face", "clearance: expected 0.5 mm", "coverage: another face")
    broken = [Finding("must fix", 1, "bar", "violation", "bar", each) for each in words]
    assert [group.words for group in grouped(broken)] == ["3 violations: coverage, clearance"]


def test_pockets_of_powder_are_counted_with_their_volume():
    pockets = [Finding("worth a check", 1, "bar", "powder pocket", "s", "", volume_mm3=v) for v in (1.0, 2.5)]
    (group,) = grouped(pockets)
    assert group.words == "2 pockets of powder that cannot leave, 3.5 mm³ in total"
    assert [each.volume_mm3 for each in group.findings] == [2.5, 1.0]


def test_regions_of_a_thread_are_one_group():
    thread = [
        overhang(f"overhang {k}", "self-supporting", kind="ledge", size=0.4, limit=1.0) for k in range(400)
    ]
    assert len(grouped(findings_of(run_of(thread)))) == 1


def test_counts_name_all_classes():
    counts = count_by_triage(findings_of(run_of([overhang("a", "must fix"), overhang("b"), overhang("c")])))
    assert counts_in_words(counts) == "1 must fix, 0 worth a check, 2 supported, 0 self-supporting"


def test_a_finding_has_no_marks_unless_they_are_given():
    assert Finding("must fix", 0, "", "", "", "").points.shape == np.empty((0, 3)).shape
