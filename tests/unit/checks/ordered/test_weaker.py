"""A setting that makes a judge more lenient is named; one that makes it stricter is not."""

from dataclasses import fields, replace

import pytest
from tests.shared.builds import box_mesh
from tests.shared.supported import SETTINGS

from amprep.checks.ordered.order import Order, as_ordered
from amprep.checks.ordered.weaker import most_lenient, weaker_orientations, weaker_part, weaker_settings
from amprep.model import Build, BuildSettings, Orientations, Overrides, SupportBody
from amprep.model.supports.rules import SupportRules
from amprep.model.supports.sizes import SupportSizes

USUAL = replace(
    SETTINGS,
    clearance=5.0,
    lift=3.0,
    reach=1.5,
    sizes=SupportSizes(2.0, 0.5, 1.0, 0.3, 2.0, 1.0),
    rules=SupportRules(
        rules="limits",
        ledge_mm=1.0,
        bridge_mm=2.0,
        bore_mm=8.0,
        least_wall_mm=0.3,
        least_contact_mm2=0.1,
        leg_ratio=10.0,
        contact_spacing_mm=2.0,
        territory="own",
        territory_margin_mm=2.5,
        drift_ratio=0.33,
        drift_mm=15.0,
        gap_mm=0.2,
    ),
)

WEAKER = {
    "clearance": 0.0, "lift": 2.9, "overlap": 50.0, "reach": 1.6, "supported": False,
    "overhang_angle_deg": 44.0, "ledge_mm": 1.1, "bridge_mm": 3.0, "bore_mm": 100.0, "plate_mm": 0.5,
    "layer_mm": 0.3, "min_area_mm2": 5.0, "min_length_mm": 5.0, "least_wall_mm": 0.0, "least_contact_mm2": 0.0,
    "leg_ratio": 0.0, "contact_spacing_mm": 3.0, "territory": "shared", "territory_margin_mm": 20.0,
    "drift_ratio": 0.0, "drift_mm": 0.0, "gap_mm": 0.0, "grounding": "anywhere",
    "tip_width_mm": 0.6, "tip_height_mm": 2.0, "base_margin_mm": 5.0, "base_height_mm": 2.0,
}  # fmt: skip
STRICTER = {
    "clearance": 6.0, "lift": 4.0, "overlap": 0.05, "reach": 1.0, "overhang_angle_deg": 50.0, "ledge_mm": 0.5,
    "bridge_mm": 1.0, "bore_mm": 2.0, "rules": "thesis", "least_wall_mm": 0.5, "leg_ratio": 5.0,
    "contact_spacing_mm": 1.0, "territory_margin_mm": 0.0, "drift_mm": 10.0, "gap_mm": 1.0,
}  # fmt: skip


def changed(name, value):
    for record in ("rules", "sizes"):
        own = getattr(USUAL, record)
        if name in {each.name for each in fields(own)}:
            return replace(USUAL, **{record: replace(own, **{name: value})})
    return replace(USUAL, **{name: value})


def test_a_support_is_judged_by_no_reach_and_no_sizes_that_are_weaker_than_ordered():
    mesh = box_mesh((0, 0, 0), (1, 1, 1))
    usual, finer, wider, tipped = (
        SupportBody(name, mesh, (0,), reach=reach, sizes=sizes)
        for name, reach, sizes in (
            ("usual", None, None),
            ("finer", 0.9, USUAL.sizes),
            ("wider", 40.0, USUAL.sizes),
            ("tipped", 0.9, replace(USUAL.sizes, tip_width_mm=USUAL.sizes.tip_width_mm + 0.2)),
        )
    )
    build = Build(USUAL, (), (usual, finer, wider, tipped))
    assert [each.setting for each in weaker_settings(most_lenient(build), USUAL)] == [
        "reach_mm",
        "tip_width_mm",
    ]
    assert weaker_settings(most_lenient(build), most_lenient(build)) == []
    judged = as_ordered(build, Order("job.toml", USUAL))
    assert [judged.settings.reach_of(each) for each in judged.supports] == [
        USUAL.reach,
        0.9,
        USUAL.reach,
        USUAL.reach,
    ]
    assert {judged.settings.sizes_of(each) for each in judged.supports} == {USUAL.sizes}


@pytest.mark.parametrize("name", WEAKER)
def test_a_weaker_setting_is_named_alone(name):
    (found,) = weaker_settings(changed(name, WEAKER[name]), USUAL)
    known = {"supported": "enabled"}.get(name, name)
    assert found.setting in (known, f"{known}_mm")
    assert found.words("usual").endswith(")")


@pytest.mark.parametrize("name", STRICTER)
def test_a_stricter_setting_is_not_named(name):
    assert weaker_settings(changed(name, STRICTER[name]), USUAL) == []


def test_every_setting_is_judged_or_known_to_be_harmless():
    harmless = {"build_id", "space", "target", "printer", "rules", "supports_as", "sizes", "plate_origin"}
    harmless |= {"planning"}  # what replanning reads, and no judge
    harmless |= {"noncritical_angle_deg", "strut_angle_deg", "square_mm", "neck_mm"}
    every = [each.name for record in (BuildSettings, SupportRules, SupportSizes) for each in fields(record)]
    assert set(every) - harmless == set(WEAKER)


def test_limits_are_weaker_than_the_rules_of_the_thesis():
    thesis = replace(USUAL, rules=replace(USUAL.rules, rules="thesis"))
    assert [each.setting for each in weaker_settings(USUAL, thesis)] == ["rules"]


@pytest.mark.parametrize(
    ("found", "weaker"),
    [
        ({"supports": False}, True),
        ({"clearance_mm": 1.0}, True),
        ({"clearance_mm": 9.0}, False),
        ({"overhang_angle_deg": 10.0}, True),
        ({"territory_margin_mm": 9.0}, True),
        ({}, False),
    ],
)
def test_settings_of_a_part_are_compared_with_those_that_it_should_have(found, weaker):
    assert bool(weaker_part("a", Overrides(**found), Overrides(), USUAL)) == weaker
    assert weaker_part("a", Overrides(**found), Overrides(**found), USUAL) == []


def test_more_freedom_of_rotation_is_weaker():
    free, fixed = Orientations("free"), Orientations()
    assert [each.setting for each in weaker_orientations("a", free, fixed)] == ["a: rotations"]
    assert weaker_orientations("a", fixed, free) == []
