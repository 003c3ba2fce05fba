"""Teeth and points are placed on the contact, one in each cell that has any."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.connectors.sites import find_sites, squares_in_cells

SIDE = 2.0
COLUMNS = ConnectorColumns(
    np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]),
    np.array([[2.0, 2.0, 10.0], [4.0, 2.0, 10.0]]),
    np.array([[0, 0], [0, 1]]),
    np.array([0.0, 0.0, SIDE]),
    (1, 2),
)


def rectangle(x0, y0, x1, y1, height):
    """Return two triangles that face down over a rectangle; `height` is a function of x and y."""
    a, b, c, d = ((x, y, height(x, y)) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1)))
    return np.array([[a, c, b], [a, d, c]])


def level(x, y):
    return 5.0


def test_a_face_over_all_squares_gives_the_centres_of_all_cells():
    sites = find_sites(rectangle(0, 0, 4, 2, level), COLUMNS, 2, 0.4)
    assert len(sites.column) == 8
    assert sites.spot == pytest.approx((sites.lo + sites.hi) / 2)
    assert sites.fraction == pytest.approx(np.ones(8))
    assert sites.lowest == pytest.approx(np.full(8, 5.0))
    assert np.bincount(sites.column).tolist() == [4, 4]


def test_cells_without_contact_get_no_site():
    sites = find_sites(rectangle(0, 0, 1, 2, level), COLUMNS, 2, 0.4)
    assert sites.column.tolist() == [0, 0]
    assert (sites.hi[:, 0] <= 1.0).all()


def test_a_contact_beside_the_centre_moves_the_site_to_its_centroid():
    (spot,) = find_sites(rectangle(0.2, 0.4, 0.6, 0.8, level), COLUMNS, 1, 0.1).spot
    assert spot == pytest.approx([0.4, 0.6])


def test_a_lowest_point_inside_the_cell_attracts_the_site():
    def cone(x, y):
        return 3.0 + abs(x - 0.5)

    contact = np.concatenate([rectangle(0, 0, 0.5, 2, cone), rectangle(0.5, 0, 2, 2, cone)])
    contact[..., 2] += 0.01 * contact[..., 1]  # the lowest point is on the side: no site is moved
    (spot,) = find_sites(contact, COLUMNS, 1, 0.2).spot
    assert spot == pytest.approx([1.0, 1.0])
    tip = np.array([[0.5, 0.7, 3.0]])
    corners = np.array([[0, 0, 4], [2, 0, 4], [2, 2, 4], [0, 2, 4]], float)
    fan = [[tip[0], b, a] for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    sites = find_sites(np.array(fan), COLUMNS, 1, 0.2)
    assert np.linalg.norm(sites.spot - tip[:, :2]) == pytest.approx(0.1)
    assert sites.lowest == pytest.approx([3.0], abs=1e-9)


@examples(30)
@given(st.integers(0, 10**6), st.integers(1, 3))
def test_every_site_is_in_its_cell_and_on_the_contact(seed, count):
    rng = np.random.default_rng(seed)
    contact = np.concatenate(
        [
            rectangle(rng.uniform(0, 4, 2).min(), 0.0, rng.uniform(2, 4), rng.uniform(0.5, 2), level)
            for _ in range(2)
        ]
    )
    sites = find_sites(contact, COLUMNS, count, 0.1)
    assert (sites.lo <= sites.spot).all()
    assert (sites.spot <= sites.hi).all()
    low, high = contact.min(axis=1)[::2, :2], contact.max(axis=1)[::2, :2]
    for spot in sites.spot:
        assert ((low - 1e-9 <= spot) & (spot <= high + 1e-9)).all(axis=1).any()
    assert ((sites.fraction > 0) & (sites.fraction <= 2 + 1e-9)).all()


def test_squares_are_moved_into_their_cells_and_not_wider():
    spot = np.array([[0.1, 0.5], [0.5, 0.5]])
    low, high = squares_in_cells(spot, 0.4, np.zeros((2, 2)), np.ones((2, 2)))
    assert low == pytest.approx(np.array([[0.0, 0.3], [0.3, 0.3]]))
    assert high == pytest.approx(low + 0.4)
    low, high = squares_in_cells(spot, 3.0, np.zeros((2, 2)), np.ones((2, 2)))
    assert (low.tolist(), high.tolist()) == ([[0, 0]] * 2, [[1, 1]] * 2)
