"""Every reason for an unsupported overhang has its advice; minor regions have none."""

import re

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.job.loading import make_job
from amprep.model import Build, BuildSettings, Part, PlacedPart, Unsupported
from amprep.model.supports import EXCEPTED, REASONS
from amprep.pipeline.advice import advice_for

ADVICE = {
    "no free voxel below": "1 region has no free voxel below it at a pitch of 2 mm; .* --set supports.pitch_mm=1",
    "connector blocked": "--set supports.pitch_mm=1",
    "enclosed": "no path to the build plate; .* --set supports.grounding=anywhere",
    "capacity": "a path that other supports use up already; .* --set supports.escalation=cut",
    "time limit": "allow a longer time limit",
    "slender": "leg of more than .* to 1 .* --set supports.leg_ratio=0",
    "territory": "outside the territory of the part .*grounding=anywhere; .* --set supports.territory=shared",
}


def advice(*reasons, minor=False, pitch=2.0, **settings):
    table = {"printer": "EOS M290", "supports": {"pitch_mm": pitch, **settings}}
    job = make_job(table, name="job", folder=None, source="job")
    part = PlacedPart("p", Part("p", box_mesh((0, 0, 5), (100, 100, 50)), 500_000.0), np.eye(4))
    regions = tuple(
        Unsupported(0, "overhang 1 of p", "face", reason, 1.0, np.zeros((1, 3)), 1.0, minor)
        for reason in reasons
    )
    build_settings = BuildSettings("b", job.printer.space, rules=job.supports)
    return list(advice_for(job, Build(build_settings, (part,), (), regions), pitch))


def test_the_advice_covers_all_reasons():
    assert set(ADVICE) == set(REASONS) - {EXCEPTED}, "what a rule excepts needs no advice"


@pytest.mark.parametrize("reason", ADVICE)
def test_each_reason_has_its_advice(reason):

    (sentence,) = advice(reason)
    assert re.search(ADVICE[reason], sentence)


def test_minor_regions_and_settings_that_are_set_already_get_no_advice():
    assert advice("enclosed", "capacity", minor=True) == []
    assert advice("enclosed", grounding="anywhere") == []


def test_regions_are_counted():
    assert advice("no free voxel below", "connector blocked")[0].startswith("2 regions have")


def test_a_finer_pitch_comes_with_the_memory_that_it_takes():
    assert "--set supports.memory_mb=" in advice("no free voxel below", memory_mb=1)[0]


@pytest.mark.parametrize(
    ("pitch", "expected"), [(2.0, "pitch_mm=1"), (1.2, "pitch_mm=0.8"), (0.8, "no remedy")]
)
def test_no_pitch_is_proposed_at_which_walls_would_close_the_cells(pitch, expected):
    (sentence,) = advice("no free voxel below", pitch=pitch, least_wall_mm=0.3)
    assert expected in sentence
    assert (pitch > 0.8) == ("--set" in sentence)
