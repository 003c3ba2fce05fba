"""A build records the settings by which its supports were planned, and its job is made of them again."""

from dataclasses import replace
from pathlib import Path

import pytest

from amprep.errors import JobError
from amprep.job import make_job
from amprep.job.planning import job_of_build, planning_table
from amprep.pipeline.supporting import build_settings

TABLE = {
    "printer": "EOS M290",
    "seed": 7,
    "packing": {"clearance_mm": 3.0, "lift_mm": 2.0},
    "supports": {"overhang_angle_deg": 40.0, "grounding": "anywhere", "edge_capacity": 3, "gap_mm": 0.2},
    "cells": {"strategy": "prism", "connector": "teeth", "base": "flange"},
    "rule": [{"kind": "tip", "connector": "point"}, {"part": "b", "support": False}],
}


def made(**changes):
    return make_job({**TABLE, **changes}, name="job", folder=None, source="test")


def again(job, planning=None):
    settings = build_settings(job, "job.build-1", 1.2)
    return job_of_build(replace(settings, planning=planning or settings.planning), Path("x.3mf"))


def test_the_job_of_a_build_plans_supports_by_the_same_settings():
    job = made()
    found = again(job)
    assert found.supports == replace(job.supports, pitch_mm=1.2), "the pitch is the one that was chosen"
    assert (found.cells, found.rules, found.seed) == (job.cells, job.rules, 7)
    assert (found.printer.space, found.printer.name) == (job.printer.space, "EOS M290")
    assert (found.packing.clearance_mm, found.packing.lift_mm) == (3.0, 2.0)


def test_of_the_file_of_a_cell_only_the_name_is_recorded(tmp_path):
    (tmp_path / "my.toml").write_text("")
    job = make_job({"cells": {"strategy": "my.toml"}}, name="job", folder=tmp_path, source="test")
    assert planning_table(job)["cells"]["strategy"] == "my.toml"


@pytest.mark.parametrize(
    ("planning", "words"),
    [
        ({"cells": {"strategy": "/etc/cell.toml"}}, "must be a name"),
        ({"rule": [{"cell": "../cell.toml", "kind": "tip"}]}, "must be a name"),
        ({"cells": {"strategy": "my.toml"}}, "no file at"),
        ({"supports": 3}, "expected a table"),
        ({"supports": {"speed": 1}}, "unknown key 'speed'"),
        ({"rule": [{"kind": 5}]}, "kind"),
    ],
)
def test_damaged_records_are_refused(planning, words):
    with pytest.raises(JobError, match=words):
        again(made(), planning)
