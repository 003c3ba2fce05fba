"""Regions are shrunk, and their width is told, also beside slivers that rounding left."""

import numpy as np
import pytest
from manifold3d import CrossSection, FillRule

from amprep.geometry.plates.inward import is_wide, shrunk

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


def test_a_region_beside_a_sliver_shrinks_as_it_does_alone():
    both = CrossSection([SQUARE, SLIVER], FillRule.NonZero)
    assert shrunk(both, 1.0).area() == pytest.approx(64.0)
    two = CrossSection([SQUARE, SLIVER, SQUARE + (20.0, 0.0)], FillRule.NonZero)
    assert shrunk(two, 1.0).area() == pytest.approx(128.0)
    assert shrunk(two, 6.0).is_empty()
