"""The judges of beams find invalid arrays, beams outside, beams in parts, and beams that float."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.optional import present

from amprep.checks.supports.beams import count_floating, deepest_place, enters_box, excess_of, fault_of
from amprep.model import BuildVolume, Lattice, Mesh
from amprep.testing.problems import box_mesh

BOX = BuildVolume(np.array([20.0, 20.0, 20.0]))
CYLINDER = BuildVolume(np.array([20.0, 20.0, 20.0]), shape="cylinder")
NONE = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))


def lattice(*beams, solids=NONE, radius=0.5, room=None):
    """Return beams between pairs of points."""
    nodes = np.array(beams, float).reshape(-1, 3)
    struts = np.arange(len(nodes), dtype=np.int32).reshape(-1, 2)
    return Lattice(nodes, struts, np.full(struts.shape, radius), solids, NONE, room)


UPRIGHT = (10, 10, 0), (10, 10, 8)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"struts": np.array([[0, 7]])}, "two of the nodes"),
        ({"struts": np.array([[1, 1]])}, "two of the nodes"),
        ({"nodes": np.array([[0, 0, np.nan], [0, 0, 1]])}, "non-finite"),
        ({"radii": np.array([[0.5, 0.0]])}, "above 0"),
        ({"radii": np.array([[0.5, np.inf]])}, "above 0"),
        ({"radii": np.empty((0, 2))}, "two radii"),
        ({"struts": np.empty((0, 2), np.int32), "radii": np.empty((0, 2))}, "two radii"),
    ],
)
def test_invalid_arrays_are_named(change, word):
    own = lattice(UPRIGHT)
    assert fault_of(own) == ""
    assert word in fault_of(replace(own, **change))


def test_the_excess_is_that_of_the_balls_at_the_ends():
    assert excess_of(lattice(UPRIGHT), BOX) == pytest.approx(0.5), "the lower ball is half below the plate"
    assert excess_of(lattice(((1, 1, 5), (19.8, 1, 5))), BOX) == pytest.approx(0.3)
    assert excess_of(lattice(((3, 3, 5), (10, 10, 5))), CYLINDER) == pytest.approx(np.hypot(7, 7) + 0.5 - 10)
    room = np.array([[0, 0, 0], [20, 20, 20]], float)
    assert excess_of(lattice(UPRIGHT, room=room), BOX) == pytest.approx(0.0), "the room clips beams"


def test_a_beam_enters_a_box_where_its_surface_does():
    beam = lattice(((2, 2, 5), (18, 2, 5)))
    assert enters_box(beam, np.array([9.0, 2.3, 0]), np.array([11.0, 4, 20]))
    assert not enters_box(beam, np.array([9.0, 2.6, 0]), np.array([11.0, 4, 20]))


def test_depth_in_a_part_is_measured_upwards():
    part = box_mesh((5, 5, 8), (15, 15, 13))
    touching, deep = lattice(((10, 10, 0), (10, 10, 7.5))), lattice(((10, 10, 0), (10, 10, 9)))
    assert deepest_place(touching, part, 0.1) is None
    x, y, z = present(deepest_place(deep, part, 0.1))
    assert (x, y) == (10, 10)
    assert 8.1 - 0.5 < z <= 9, "the ball of radius 0.5 is more than 0.1 deep"
    assert deepest_place(deep, part, 2.0) is None


def test_beams_and_solids_that_touch_nothing_on_the_plate_float():
    def on_plate(points):
        return points[:, 2] <= 1e-3

    assert count_floating(lattice(UPRIGHT), on_plate) == 0
    high = (2, 2, 5), (4, 2, 6)
    assert count_floating(lattice(UPRIGHT, high), on_plate) == 1
    cap = box_mesh((9, 9, 7.8), (11, 11, 8.8))
    assert count_floating(lattice(UPRIGHT, solids=cap), on_plate) == 0, "the beam carries the solid"
    assert count_floating(lattice(high, solids=cap), on_plate) == 2
    assert count_floating(lattice(high, solids=cap), lambda points: points[:, 2] < 100) == 1
