"""Needed areas never exceed the plate in layouts that exist, and are near it in tight ones."""

import numpy as np
import pytest
from manifold3d import CrossSection

from amprep.geometry.plates.areas import needed_area, plate_area


@pytest.mark.parametrize("clearance", [0.0, 0.5, 3.0])
def test_squares_that_just_fit_need_at_most_the_plate(clearance):
    side = 4 * 10.0 + 5 * clearance
    room = plate_area(np.array([side, side]), clearance, round_plate=False)
    need = 16 * needed_area(CrossSection.square((10.0, 10.0)), clearance)
    assert 0.9 * room < need <= room


@pytest.mark.parametrize("clearance", [0.0, 2.0])
def test_a_disc_that_just_fits_a_round_plate_needs_at_most_the_plate(clearance):
    size = np.full(2, 40.0 + 2.0 * clearance)
    room = plate_area(size, clearance, round_plate=True)
    need = needed_area(CrossSection.circle(20.0, 720), clearance)
    assert 0.9 * room < need <= room * (1.0 + 1e-4)


def test_a_slot_that_nothing_can_enter_counts_as_filled():
    slotted = CrossSection.square((20.0, 20.0)) - CrossSection.square((1.0, 15.0)).translate((9.5, 0.0))
    assert needed_area(slotted, 2.0) == pytest.approx(
        needed_area(CrossSection.square((20.0, 20.0)), 2.0), rel=2e-3
    )
