"""Verdicts on overhang regions in words."""

import numpy as np
import pytest

from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.overhangs.verdicts import verdict_words


def region(kind, size=0.0, limit=0.0, **more):
    return OverhangRegion(kind, 1.0, np.zeros(3), size, limit, **more)


@pytest.mark.parametrize(
    ("of", "supported", "words"),
    [
        (region("bore", 3.9, 8.0, is_self_supporting=True), None, "self-supporting: bore 3.9 mm"),
        (region("ledge", 6.0, 1.0), "fully", "ledge 6.0 mm over 1.0: supported"),
        (region("bridge", 6.0, 2.0), None, "bridge 6.0 mm over 2.0: needs support"),
        (region("flat", starts_in_air=True), "not", "flat, starts in the air: not supported"),
        (region("edge", 2.9, 2.0), "partly", "knife edge 2.9 mm over 2.0: partly supported"),
        (region("tip", starts_in_air=True), "fully", "tip: supported"),
        (region("face", angle_deg=46.8), "fully", "face at 47° to the plate: supported"),
        (region("ledge", 0.4, 1.0), "fully", "ledge 0.4 mm: supported"),
    ],
)
def test_a_verdict_says_kind_size_limit_and_who_carries_the_region(of, supported, words):
    assert verdict_words(of, supported) == words
