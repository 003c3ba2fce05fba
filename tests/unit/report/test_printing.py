"""Plate use, mass and hours in words: totals over all builds, with the unit that fits."""

from dataclasses import replace

import pytest

from amprep.measures.printing.estimate import PrintingEstimate
from amprep.report.printing import (
    hours_words,
    mass_words,
    printing_json,
    printing_words,
    total_cost,
    total_mass_g,
)

ONE = PrintingEstimate(800.0, 40.0, 0.25, 0.1, 500, 1.4, 3.0)


def test_the_line_of_one_build_has_plate_use_mass_layers_and_hours():
    assert printing_words([ONE]) == (
        "plate use 25.0 %, mass 840.0 g (supports 40.0 g), 500 layers, about 4.4 h (recoating 1.4 h, scanning 3.0 h)"
    )


def test_several_builds_have_the_mean_plate_use_and_the_sums_of_the_rest():
    words = printing_words([ONE, ONE])
    assert words.startswith("mean plate use 25.0 %, mass 1.68 kg (supports 80.0 g), 1000 layers, about 8.8 h")


def test_a_mass_is_unknown_if_that_of_one_build_is():
    unknown = PrintingEstimate(800.0, None)
    assert total_mass_g([ONE]) == 840.0
    assert total_mass_g([ONE, unknown]) is None
    assert "mass unknown" in printing_words([ONE, unknown])


def test_no_builds_take_nothing():
    assert printing_words([]) == ""


@pytest.mark.parametrize(
    ("grams", "words"), [(None, ("unknown", "")), (3.04, ("3.0", "g")), (1000.0, ("1.00", "kg"))]
)
def test_masses_are_in_grams_below_a_kilogram(grams, words):
    assert mass_words(grams) == words


@pytest.mark.parametrize(
    ("hours", "words"), [(0.0, "0 min"), (0.5, "30 min"), (1.0, "1.0 h"), (30.04, "30.0 h")]
)
def test_durations_are_in_minutes_below_an_hour(hours, words):
    assert hours_words(hours) == words


def test_the_report_has_the_sum_of_the_hours():
    assert printing_json(ONE)["hours"] == pytest.approx(4.4)


def test_heating_cooling_and_cost_are_told_where_they_are_known():
    whole = replace(ONE, heating_h=1.0, cooling_h=0.6, cost=1234.5)
    assert printing_words([whole, whole]).endswith(
        "about 12.0 h (recoating 2.8 h, scanning 6.0 h, heating and cooling 3.2 h), cost 2,469.00"
    )
    assert total_cost([whole, ONE]) is None
    assert "cost" not in printing_words([whole, ONE])
    assert printing_json(whole)["cost"] == 1234.5
