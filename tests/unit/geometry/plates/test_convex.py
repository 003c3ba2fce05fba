"""Convex pieces of polygons are convex, disjoint, and together the polygon."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, OpType
from tests.shared.examples import examples
from tests.shared.plates import star

from amprep.geometry.plates.convex import convex_pieces


@examples(40)
@given(seed=st.integers(0, 10**6))
def test_pieces_are_convex_and_cover_the_polygon_once(seed):
    rng = np.random.default_rng(seed)
    region = CrossSection([star(rng, 15, 10.0)]) - CrossSection([star(rng, 6, 3.0)])
    loops = [np.asarray(loop) for loop in region.to_polygons()]
    pieces = convex_pieces(loops)
    parts = [CrossSection([piece]) for piece in pieces]
    assert sum(part.area() for part in parts) == pytest.approx(region.area(), rel=1e-6)
    assert CrossSection.batch_boolean(parts, OpType.Add).area() == pytest.approx(region.area(), rel=1e-6)
    for piece, part in zip(pieces, parts, strict=True):
        assert part.hull().area() == pytest.approx(part.area(), abs=1e-6)
        assert len(piece) >= 3


def test_a_rectangle_with_many_corners_on_its_sides_is_one_piece():
    side = np.linspace(0.0, 1.0, 6)[:-1]
    corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
    loop = np.concatenate(
        [a + side[:, None] * (np.roll(corners, -1, 0)[k] - a) for k, a in enumerate(np.array(corners))]
    )
    assert len(convex_pieces([loop])) == 1
