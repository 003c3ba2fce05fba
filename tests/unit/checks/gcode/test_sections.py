"""Regions of sections that differ are found, also beside slivers that rounding left."""

import numpy as np
from manifold3d import CrossSection, FillRule

from amprep.checks.gcode.sections import is_wide

SQUARE = np.array([[0.0, -12.0], [10.0, -12.0], [10.0, -2.0], [0.0, -2.0]])
SLIVER = np.array(
    [
        [2.150074452161789, 2.0709661841392517],
        [2.007390022277832, 2.2294299602508545],
        [2.1444789841771126, 2.0771804451942444],
        [2.4270501136779785, 1.7633600234985352],
    ]
)
"""From the difference of two sections of a printed part; its area is 4e-10 mm2."""


def test_a_sliver_does_not_hide_a_wide_region():
    both = CrossSection([SQUARE, SLIVER], FillRule.NonZero)
    assert is_wide(both, 9.9)
    assert not is_wide(both, 10.1)
    assert not is_wide(CrossSection([SLIVER], FillRule.NonZero), 0.001)
    assert not is_wide(CrossSection(), 0.001)
