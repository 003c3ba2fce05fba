"""Inflated pieces contain everything within the clearance and reach no farther than promised."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.convex import random_sets
from tests.shared.examples import examples

from amprep.geometry.bounding.convex.collision import pieces_distance
from amprep.geometry.bounding.convex.inflate import inflate_piece, inflate_pieces
from amprep.geometry.bounding.convex.prepared import planes_of, prepare_pieces


@given(st.integers(0, 10**6), st.floats(0.05, 3.0), st.sampled_from([1.1, 1.2, 1.5]))
@examples(30)
def test_an_inflated_piece_contains_the_clearance_and_keeps_the_reach(seed, clearance, reach):
    piece = random_sets(seed, most=1)[0].vertices
    corners = inflate_piece(piece, clearance, reach)
    planes = planes_of(corners)
    around = np.random.default_rng(seed).normal(size=(500, 3))
    around *= clearance / np.linalg.norm(around, axis=1)[:, None]
    within = (piece[:, None] + around).reshape(-1, 3)
    assert (within @ planes[:, :3].T <= planes[:, 3]).all()
    still = np.eye(4)
    single = [prepare_pieces([corner[None]]) for corner in corners]
    away = [float(pieces_distance(prepare_pieces([piece]), s, still, still)[0]) for s in single]
    assert max(away) <= reach * clearance * (1 + 1e-6) + 1e-8


def test_the_inflated_cube_is_a_cube_with_cut_corners():
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    corners = inflate_piece(cube, 1.0, reach=2.0)
    assert len(corners) == 8
    assert np.abs(corners - 0.5) == pytest.approx(1.5)
    assert len(inflate_piece(cube, 1.0, reach=1.5)) > 8


def test_a_flat_piece_is_inflated_on_both_sides():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    corners = inflate_piece(square, 0.5)
    assert corners[:, 2].min() == pytest.approx(-0.5)
    assert corners[:, 2].max() == pytest.approx(0.5)


def test_without_clearance_a_set_stays_itself():
    pieces = random_sets(3)[0]
    assert inflate_pieces(pieces, 0.0) is pieces
