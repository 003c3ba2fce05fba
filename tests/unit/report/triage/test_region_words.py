"""Regions of overhangs are summed up by kind, with the range of their sizes."""

import numpy as np
import pytest

from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.report.triage.region_words import kinds_in_words, regions_in_words


def regions(kind, *sizes, limit=0.0, measure=1.0):
    return [OverhangRegion(kind, measure, np.zeros(3), size, limit) for size in sizes]


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (regions("bore", 4.2, 3.0, 3.5, limit=8.0), "3 bores 3.0 to 4.2 mm, limit 8 mm"),
        (regions("ledge", 0.94, 0.86), "2 ledges 0.9 mm"),
        (regions("ledge", 1.0, limit=1.0) + regions("ledge", 2.0, limit=2.0), "2 ledges 1.0 to 2.0 mm"),
        (regions("flat", 0.0, measure=5.0), "1 flat 5.0 mm²"),
        (regions("edge", 0.0, 0.0, measure=3.0), "2 knife edges 3.0 mm long"),
        (regions("tip", 0.0, measure=0.0), "1 tip"),
    ],
)
def test_number_sizes_and_common_limit_are_stated(found, words):
    assert regions_in_words(found) == words


def test_the_kind_with_the_most_regions_is_first():
    found = regions("bore", 3.0) + regions("ledge", 1.0, 2.0)
    assert kinds_in_words(found) == "2 ledges 1.0 to 2.0 mm; 1 bore 3.0 mm"


def test_no_regions_are_none():
    assert kinds_in_words([]) == "none"
