"""One line states by which rules supports were planned."""

from dataclasses import replace

import pytest

from amprep.model import BuildSettings, BuildVolume
from amprep.model.supports.rules import SupportRules
from amprep.report.record import BuildRecord, RunRecord
from amprep.report.triage.rules import rules_of, rules_words

METAL = SupportRules(rules="limits", ledge_mm=1.0, bridge_mm=2.0, bore_mm=8.0)
SETTINGS = BuildSettings("job.build-1", BuildVolume((10, 10, 10)), rules=METAL, lift=3.0, clearance=5.0)


def test_the_line_has_material_limits_angle_territory_lift_and_distance():
    assert rules_words(SETTINGS, "metal") == (
        "material metal: faces flatter than 45 degrees need support, but not ledges up to 1 mm, bridges up to 2 mm, "
        "bores up to 8 mm; supports may stand anywhere on the plate; lift 3 mm, part distance 5 mm"
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rules": "thesis"}, "rules of the thesis: all faces flatter than 45 degrees need support"),
        ({"bore_mm": 1000.0}, "bores of any size"),
        ({"noncritical_angle_deg": 50.0}, "need support (45 to 50 degrees not critical)"),
        (
            {"territory": "own", "territory_margin_mm": 2.5},
            "supports stay within 2.5 mm of the shadow of their part",
        ),
    ],
)
def test_other_rules_are_stated(changes, words):
    assert words in rules_words(replace(SETTINGS, rules=replace(METAL, **changes)), "metal")


def test_positions_of_the_user_have_no_distances_and_an_unknown_material_no_name():
    given = replace(SETTINGS, lift=0.0, clearance=0.0)
    words = rules_words(given, "")
    assert words.startswith("faces flatter than 45 degrees")
    assert words.endswith("anywhere on the plate")


def test_a_run_states_its_rules_once_and_distances_that_are_stated_as_defaults_not_again(make_build):
    entry = BuildRecord(replace(make_build(), settings=SETTINGS))
    run = RunRecord("job", "1.0", 0, "M290", "generic", (entry, entry), material="metal")
    assert rules_of(run) == [rules_words(SETTINGS, "metal")]
    assert "lift" not in rules_of(replace(run, by_default=("lift 3 mm by default",)))[0]


def test_a_run_without_supports_states_no_rules(make_build):
    entry = BuildRecord(replace(make_build(), settings=replace(SETTINGS, supported=False)))
    assert rules_of(RunRecord("job", "1.0", 0, "M290", "generic", (entry,))) == []
