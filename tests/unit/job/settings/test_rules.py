"""A rule changes the settings that it names and keeps the others of the job."""

from pathlib import Path

import pytest

from amprep.errors import JobError
from amprep.job.loading import make_job
from amprep.job.overrides import apply_sets, override


def job(*rules, **sections):
    return make_job({"rule": list(rules), **sections}, name="job", folder=Path(), source="job")


def test_a_rule_changes_only_what_it_names():
    own = job(
        {"kind": "edge", "connector": "point", "point_mm": 0.4, "pitch_mm": 0.9},
        cells={"tooth_width_mm": 0.7, "base": "raft"},
        supports={"gap_mm": 0.3},
    )
    changed = own.for_rule(1)
    assert (changed.cells.connector, changed.cells.point_mm) == ("point", 0.4)
    assert (changed.cells.tooth_width_mm, changed.cells.base) == (0.7, "raft")
    assert (changed.supports.pitch_mm, changed.supports.gap_mm) == (0.9, 0.3)
    assert own.for_rule(0) is own


def test_parameters_are_added_to_those_of_the_same_cell_and_replace_those_of_another():
    cells = {"strategy": "x-wall", "params": {"thickness_mm": 0.4}}
    own = job({"params": {"window": 0.1}}, {"cell": "prism"}, {"cell": "x-wall", "params": {}}, cells=cells)
    params = [own.for_rule(number).cells.params for number in (1, 2, 3)]
    assert params == [{"thickness_mm": 0.4, "window": 0.1}, {}, {"thickness_mm": 0.4}]


def test_a_rule_is_checked_with_the_settings_of_the_job():
    narrow = {"connector": "teeth", "tooth_width_mm": 0.4}
    assert job({"neck_mm": 0.3}, cells=narrow).for_rule(1).cells.neck_mm == 0.3
    with pytest.raises(JobError, match=r"job: \[\[rule\]\] 1: neck_mm must be below the tip width of 0.4 mm"):
        job({"neck_mm": 0.45}, cells=narrow)


def test_set_changes_the_rest_of_the_job_and_python_the_rules_too():
    own = job({"kind": "tip", "support": False})
    assert apply_sets(own, ["supports.pitch_mm=3"]).rules == own.rules
    with pytest.raises(JobError, match="entries of a list cannot be set"):
        apply_sets(own, ["rule.support=true"])
    assert override(own, {"rule": []}).rules == ()
