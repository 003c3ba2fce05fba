"""Rules for connectors and bases check themselves; a job file with the same values is refused for the same reason."""

import pytest

from amprep.model.contacts import BaseRules, ConnectorRules


@pytest.mark.parametrize(
    ("kind", "width", "height"), [("teeth", 0.4, 0.7), ("point", 0.3, 0.9), ("full", 0.4, 0.7)]
)
def test_tips_have_the_measures_of_their_kind(kind, width, height):
    rules = ConnectorRules(kind, None, 0.4, 0.7, None, 0.3, 0.9)
    assert (rules.tip_width_mm, rules.tip_height_mm) == (width, height)
    assert rules.has_tips == rules.is_shaped == (kind != "full")


def test_perforated_or_necked_columns_are_shaped():
    assert ConnectorRules(perforation_mm=0.5).is_shaped
    assert ConnectorRules(neck_mm=0.5).is_shaped
    assert not ConnectorRules().is_shaped


def test_bases_have_the_measures_of_their_kind():
    assert (BaseRules("raft").base_margin_mm, BaseRules("flange").base_margin_mm) == (2.0, 1.0)
    assert BaseRules("raft", raft_height_mm=0.9).base_height_mm == 0.9


@pytest.mark.parametrize(
    ("make", "rule"),
    [
        (lambda: ConnectorRules(tooth_width_mm=0.0), "tooth_width_mm must be at least"),
        (lambda: ConnectorRules(point_pitch_mm=0.5), "point_pitch_mm must be above the width"),
        (lambda: ConnectorRules("extend", perforation_mm=0.5), "need connector"),
        (lambda: ConnectorRules("teeth", neck_mm=0.5), "neck_mm must be below"),
        (lambda: BaseRules(flange_mm=60.0), "flange_mm must be between"),
        (lambda: BaseRules(raft_hole_mm=0.01), "raft_hole_mm must be 0 or at least"),
    ],
)
def test_values_out_of_bounds_are_refused(make, rule):
    with pytest.raises(ValueError, match=rule):
        make()
