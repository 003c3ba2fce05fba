"""Conditions on regions are met by the regions inside all ranges, and by no others."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.builds import box_mesh
from tests.shared.examples import examples

from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.model import Part
from amprep.overhangs.conditions import RegionConditions

BRACKET = Part("bracket", box_mesh((0, 0, 0), (1, 1, 1)), 1.0, source="/jobs/left bracket.stl")
LEDGE = OverhangRegion("ledge", 30.0, np.zeros(3), size_mm=4.0, limit_mm=1.0, angle_deg=20.0, lowest_mm=12.0)


def fits(region=LEDGE, paint=(), **conditions):
    return RegionConditions(**conditions).are_met(region, BRACKET, paint)


def test_no_condition_is_met_by_every_region():
    assert fits()


@pytest.mark.parametrize(
    ("name", "field"),
    [("angle", "angle_deg"), ("size", "size_mm"), ("area", "measure"), ("height", "lowest_mm")],
)
@given(value=st.floats(0, 50), least=st.floats(0, 50), more=st.none() | st.floats(0, 50))
@examples(40)
def test_a_range_holds_the_values_from_its_least_to_its_greatest(name, field, value, least, more):
    limits = (least,) if more is None else (least, least + more)
    expected = least <= value and (more is None or value <= least + more)
    assert fits(LEDGE._replace(**{field: value}), **{name: limits}) == expected


def test_a_region_must_meet_all_conditions():
    assert fits(kind=("bore", "ledge"), size=(3.0, 5.0), height=(10.0,))
    assert not fits(kind=("bore", "ledge"), size=(3.0, 5.0), height=(13.0,))
    assert not fits(kind="bore", size=(3.0, 5.0))


def test_edges_and_tips_have_no_area():
    assert not fits(LEDGE._replace(kind="edge"), area=(1.0, 100.0))
    assert fits(LEDGE._replace(kind="tip"), area=(0.0, 1.0))


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [("bracket", True), ("brack*", True), ("?racket", True), ("left bracket.stl", True), ("left*", True)]
    + [("rack", False), ("Bracket", False), ("/jobs/*", False)],
)
def test_a_part_is_named_by_its_name_or_its_file(pattern, expected):
    assert fits(part=pattern) == expected


def test_a_colour_is_written_in_either_case_and_a_name_as_it_is():
    assert fits(colour="#FF8800", paint={"#ff8800"})
    assert not fits(colour="#FF8800", paint={"#ff8801"})
    assert fits(colour="Rib", paint={"Rib"})
    assert not fits(colour="rib", paint={"Rib"})
