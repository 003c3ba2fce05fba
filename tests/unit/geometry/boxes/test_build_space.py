"""Positions in an empty build are compared with dense sampling; rotated boxes and unions are exact."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.arrays import Floats
from amprep.geometry.boxes.build_space import Space, find_feasible_position, rotated_boxes, union_volume


def space(size=(20.0, 20.0, 10.0), *, radius=0.0, zones=(), flat=False):
    lo = np.array([zone[:3] for zone in zones], float).reshape(-1, 3)
    hi = np.array([zone[3:] for zone in zones], float).reshape(-1, 3)
    size = np.array(size, float)
    return Space(np.zeros(3), size, size[:2] / 2.0, radius, lo, hi, flat, 1e-9)


def box(*size: float) -> tuple[Floats, Floats]:
    return np.zeros((1, 3)), np.array([size], float)


def test_a_quarter_turn_swaps_two_sides():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    lo, hi = rotated_boxes(*box(1, 2, 3), turn)
    assert lo.tolist() == [[-2, 0, 0]]
    assert hi.tolist() == [[0, 1, 3]]


def test_an_overlap_counts_once_in_the_volume_of_a_union():
    lo, hi = (
        np.array([[0, 0, 0], [1, 1, 1], [5, 5, 5]], float),
        np.array([[2, 2, 2], [3, 3, 3], [5, 6, 6]], float),
    )
    assert union_volume(lo, hi) == pytest.approx(15.0)
    assert union_volume(np.empty((0, 3)), np.empty((0, 3))) == 0.0


def test_a_box_of_exactly_the_size_of_the_build_fits():
    assert find_feasible_position(*box(20, 20, 10), space()) is not None
    assert find_feasible_position(*box(20.001, 20, 10), space()) is None


def test_a_box_fits_a_circle_if_its_diagonal_does():
    room = space(radius=10.0)
    assert find_feasible_position(*box(12, 16, 1), room) is not None
    assert find_feasible_position(*box(12.01, 16, 1), room) is None


def test_an_item_of_two_boxes_may_fit_a_circle_although_its_enclosing_box_does_not():
    # a cross of two bars of 19 x 2: the enclosing square of 19 has a diagonal of 26.9
    cross = np.array([[0, 8.5, 0], [8.5, 0, 0]]), np.array([[19, 10.5, 1], [10.5, 19, 1]])
    assert find_feasible_position(*cross, space(radius=10.0)) is not None
    assert find_feasible_position(*box(19, 19, 1), space(radius=10.0)) is None


def test_an_item_away_from_the_centre_of_its_enclosing_box_is_placed_in_a_circle():
    # a bar with a bump: the least circle around it is not centred on the enclosing box
    shape = np.array([[0, 0, 0], [8, 0, 0]], float), np.array([[19.5, 2, 1], [12, 9, 1]], float)
    assert find_feasible_position(*shape, space(radius=10.0)) is not None


def test_without_stacking_the_item_must_be_on_the_plate():
    below = [(0, 0, 0, 20, 20, 3)]
    assert present(find_feasible_position(*box(5, 5, 5), space(zones=below)))[2] == 3.0
    assert find_feasible_position(*box(5, 5, 5), space(zones=below, flat=True)) is None


@examples(60)
@given(st.data())
def test_a_position_is_found_if_dense_sampling_finds_one(data):
    number = st.integers(1, 19)
    zones = []
    for _ in range(data.draw(st.integers(0, 3))):
        corner = [data.draw(st.integers(0, 18)) for _ in range(2)]
        zones.append((*corner, 0, *(min(20, c + data.draw(number)) for c in corner), 10))
    boxes = [(0, 0, data.draw(number), data.draw(number)), (data.draw(number), data.draw(number), 3, 2)]
    boxes = boxes[: data.draw(st.integers(1, 2))]
    lo = np.array([(x, y, 0) for x, y, _, _ in boxes], float)
    hi = lo + np.array([(w, d, 5) for _, _, w, d in boxes], float)
    room = space(radius=data.draw(st.sampled_from([0.0, 10.0])), zones=zones)
    steps = np.linspace(-20, 20, 161)
    places = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    allowed = np.ones(len(places), bool)
    for a, b in zip(lo, hi, strict=True):
        near, far = places + a[:2], places + b[:2]
        allowed &= (near >= 0).all(axis=1) & (far <= 20).all(axis=1)
        if room.radius:
            away = np.maximum(np.abs(near - 10), np.abs(far - 10))
            allowed &= np.hypot(*away.T) <= 10
        for zone in zones:
            allowed &= (far <= np.array(zone[:2])).any(axis=1) | (near >= np.array(zone[3:5])).any(axis=1)
    home = find_feasible_position(lo, hi, room)
    assert home is not None or not allowed.any()
