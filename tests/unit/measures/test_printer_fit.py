"""A part fits a build volume as it is, in an allowed orientation, in another one, or not at all."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.measures.printer_fit import poses_of
from amprep.model import BuildVolume, Orientations
from amprep.model.rotations import axis_rotations

ROD = box_mesh((5, 5, 5), (90, 10, 20)).vertices
LIES, ALLOWED, OTHER, NO = (
    "as it lies", "in an allowed orientation", "in another orientation", "does not fit",
)  # fmt: skip


def fit(size, *, allowed=None, clearance=0.0, lift=0.0, shape="box", points=ROD, **zones):
    space = BuildVolume(size, shape, **zones)
    return poses_of(points, allowed or Orientations()).fit(space, clearance, lift)


@pytest.mark.parametrize(
    ("size", "allowed", "expected"),
    [
        ([90, 10, 20], None, LIES),
        ([10, 90, 20], None, OTHER),
        ([10, 90, 20], Orientations("list", axis_rotations()), ALLOWED),
        ([10, 90, 20], Orientations("about-z"), ALLOWED),
        ([10, 20, 90], Orientations("about-z"), OTHER),
        ([10, 20, 90], Orientations("free"), ALLOWED),
        ([89, 10, 20], None, NO),
        ([72, 72, 20], None, OTHER),  # along the diagonal: (90 + 10) / sqrt(2) = 70.7
        ([70, 70, 20], None, NO),
    ],
)
def test_a_rod_fits(size, allowed, expected):
    assert fit(size, allowed=allowed) == expected


def test_clearance_and_lift_are_taken_off():
    assert fit([94, 14, 25], clearance=2.0, lift=3.0) == LIES
    assert fit([94, 24, 15], clearance=2.0, lift=3.0) == OTHER, "on its side it is 10 mm high"
    for less in ([93.9, 14, 25], [94, 13.9, 25], [94, 14, 24.9]):
        assert fit(less, clearance=2.0, lift=3.0) == NO


def test_a_round_part_needs_its_own_diameter_in_a_cylinder_and_not_that_of_its_box():
    angles = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    disc = np.array([[30 * np.cos(a), 30 * np.sin(a), z] for a in angles for z in (0.0, 5.0)])
    assert fit([60, 60, 5], shape="cylinder", points=disc) == LIES
    assert fit([59.9, 59.9, 5], shape="cylinder", points=disc) == NO


def test_a_forbidden_zone_in_the_middle_leaves_room_beside_it():
    zone = {"zone_lo": np.array([[0, 12, 0]]), "zone_hi": np.array([[100, 30, 50]])}
    assert fit([100, 50, 50], **zone) == LIES
    everywhere = {"zone_lo": np.array([[40, 0, 0]]), "zone_hi": np.array([[60, 50, 50]])}
    assert fit([100, 50, 50], **everywhere) == NO


def test_a_tilted_rod_may_be_set_down_on_one_of_its_faces():
    angle = np.radians(35.0)
    tilt = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    assert fit([90, 10, 20], points=ROD @ tilt.T) == OTHER
