"""Heights and contact areas of the packing kernels, against brute force on a grid of unit cells."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.kernels import plain

from amprep.kernels.boxes import positions

# compiled helpers are called by kernels only; from Python the plain functions run
contact_area = plain(positions.contact_area)
feasible_height = plain(positions.feasible_height)

SIDE = 6
ROOM = np.array([0.0, 0, 0, SIDE, SIDE, SIDE, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0])

corners = st.tuples(*[st.integers(0, SIDE - 1)] * 3)
sides = st.tuples(*[st.integers(1, 3)] * 3)
boxes_in_room = st.lists(st.tuples(corners, sides), max_size=5).map(
    lambda found: [(c, s) for c, s in found if all(a + b <= SIDE for a, b in zip(c, s, strict=True))]
)


def filled(boxes):
    """Which unit cells are inside a box."""
    cells = np.zeros((SIDE,) * 3, bool)
    for corner, side in boxes:
        cells[tuple(slice(c, c + s) for c, s in zip(corner, side, strict=True))] = True
    return cells


def as_rows(boxes):
    rows = [[*corner, *np.add(corner, side)] for corner, side in boxes]
    return np.array(rows, float).reshape(-1, 6)


@examples(150)
@given(boxes_in_room, corners, sides)
def test_the_feasible_height_is_the_lowest_free_one(boxes, corner, side):
    cells, own = filled(boxes), np.array([[0.0, 0, 0, *side]])
    position = tuple(float(c) for c in corner)
    found = feasible_height((0, 1), position, np.inf, own, ROOM, as_rows(boxes), len(boxes), 0)
    x, y, z = corner
    free = [
        h
        for h in range(z, SIDE - side[2] + 1)
        if not cells[x : x + side[0], y : y + side[1], h : h + side[2]].any()
    ]
    if x + side[0] > SIDE or y + side[1] > SIDE or not free:
        assert found < 0.0
    else:
        assert found == free[0]


@examples(150)
@given(boxes_in_room, corners, sides)
def test_the_contact_area_is_the_number_of_unit_faces_that_touch(boxes, corner, side):
    disjoint: list[Any] = []
    for box in boxes:
        if not (filled(disjoint) & filled([box])).any():
            disjoint.append(box)
    inside = all(c + s <= SIDE for c, s in zip(corner, side, strict=True))
    if not inside or (filled(disjoint) & filled([(corner, side)])).any():
        return
    solid = np.pad(filled(disjoint), 1, constant_values=True)
    own = np.pad(filled([(corner, side)]), 1)
    faces = sum(int((own & np.roll(solid, step, axis)).sum()) for axis in range(3) for step in (-1, 1))
    rows, relative = as_rows(disjoint), np.array([[0.0, 0, 0, *side]])
    position = tuple(float(c) for c in corner)
    assert contact_area((0, 1), position, relative, ROOM, rows, len(disjoint)) == faces


def test_a_box_in_the_way_is_named():
    own, placed = np.array([[0.0, 0, 0, 2, 2, 2]]), np.array([[0.0, 0, 0, 1, 1, 1], [3, 3, 0, 5, 5, 4]])
    assert feasible_height((0, 1), (4.0, 4.0, 0.0), 0.0, own, ROOM, placed, 2, 0) == -3.0
    assert feasible_height((0, 1), (5.0, 0.0, 0.0), 0.0, own, ROOM, placed, 2, 0) == -1.0


def test_a_box_from_wall_to_wall_touches_both_walls():
    # 10 x 4 x 3 in the corner of a 10-cube: two ends of 4 x 3, a side of 10 x 3 and the floor of 10 x 4
    room = np.array([0.0, 0, 0, 10, 10, 10, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0])
    own = np.array([[0.0, 0, 0, 10, 4, 3]])
    assert contact_area((0, 1), (0.0, 0.0, 0.0), own, room, np.empty((0, 6)), 0) == 94.0
