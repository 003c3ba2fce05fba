"""Closed cavities are found by the orientation of their shells, and told apart from known pockets."""

import numpy as np
import pytest
from tests.shared.solids import mesh_of
from tests.shared.supported import box

from amprep.geometry.meshes.containment import inside
from amprep.geometry.powder.cavities import find_cavities
from amprep.geometry.powder.pockets import Pocket

BLOCK = box((4, 4, 4), (0, 0, 0))
SLIT, ROOM = box((3, 3, 0.1), (0.5, 0.5, 3)), box((2, 2, 1), (1, 1, 1))


def test_a_solid_without_cavities_and_a_mesh_without_triangles_have_none():
    assert find_cavities(mesh_of(BLOCK).arrays) == []
    assert find_cavities((np.zeros((0, 3)), np.zeros((0, 3), np.int32))) == []


def test_the_largest_cavity_comes_first_with_its_box_and_a_point_in_it():
    room, slit = find_cavities(mesh_of(BLOCK - SLIT - ROOM).arrays)
    assert [room.volume, slit.volume] == pytest.approx([4.0, 0.9])
    assert (room.lo, room.hi) == ((1, 1, 1), (3, 3, 2))
    for cavity, solid in ((room, ROOM), (slit, SLIT)):
        assert cavity.closed
        assert inside(np.array([cavity.point]), *mesh_of(solid).arrays).all()


def test_a_cavity_with_a_known_pocket_in_it_is_left_out():
    known = Pocket(4.0, (2.0, 2.0, 1.5), (1, 1, 1), (3, 3, 2), closed=True)
    (slit,) = find_cavities(mesh_of(BLOCK - SLIT - ROOM).arrays, [known])
    assert slit.volume == pytest.approx(0.9)


def test_a_void_of_less_than_a_grain_is_no_cavity():
    assert find_cavities(mesh_of(BLOCK - box((0.04, 0.04, 0.04), (1, 1, 1))).arrays) == []
