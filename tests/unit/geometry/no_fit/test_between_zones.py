"""Shapes whose boxes do not fit among zones, although they do."""

import numpy as np
import pytest

from amprep.geometry.boxes.build_space import Space
from amprep.geometry.no_fit.between_zones import find_between_zones

WEDGE = np.array([[x, y, z] for x, y in ((0.0, 0.0), (8.0, 0.0), (0.0, 8.0)) for z in (0.0, 2.0)])


def space_with(lo, hi):
    return Space(
        np.zeros(3), np.full(3, 10.0), np.full(2, 5.0), 0.0, np.array([lo]), np.array([hi]), False, 1e-3
    )


def test_a_wedge_fits_in_front_of_a_zone_that_its_box_overlaps():
    zone = np.array([5.0, 5.0, 0.0]), np.full(3, 10.0)
    position = find_between_zones([WEDGE], space_with(*zone))
    assert position is not None
    assert position[:2].sum() <= 2.0 + 1e-6  # the zone begins where x + y is 10
    assert position[2] == pytest.approx(0.0)


def test_a_wedge_goes_above_a_zone_and_nowhere_if_that_is_too_high():
    position = find_between_zones([WEDGE], space_with(np.zeros(3), np.array([10.0, 10.0, 6.0])))
    assert position is not None
    assert position[2] >= 6.0
    assert find_between_zones([WEDGE], space_with(np.zeros(3), np.array([10.0, 10.0, 9.0]))) is None
