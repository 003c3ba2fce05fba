"""A goal bounds the number of pieces; together they contain the solid."""

import numpy as np
import pytest
from tests.shared.convex_solids import SOLIDS

from amprep.geometry.bounding.convex.cells import hull_volume
from amprep.geometry.bounding.convex.decompose import PieceGoal, decompose_by_cuts


@pytest.mark.parametrize("pieces", [1, 2, 5])
def test_there_are_at_most_as_many_pieces_as_asked_for(pieces):
    found = decompose_by_cuts(SOLIDS["spiral"](), PieceGoal(pieces, 0.0), lambda: False)
    assert 1 <= len(found) <= pieces


def test_one_piece_is_the_hull_of_the_solid():
    solid = SOLIDS["ring"]()
    (points,) = decompose_by_cuts(solid, PieceGoal(1, 0.0), lambda: False)
    assert hull_volume(np.ascontiguousarray(points)) == pytest.approx(solid.hull().volume(), rel=1e-6)
