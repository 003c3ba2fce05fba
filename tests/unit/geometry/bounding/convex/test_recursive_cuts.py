"""The cells of a solid together are the solid, with its cavities filled."""

import pytest
from manifold3d import Manifold, OpType
from tests.shared.convex_solids import SOLIDS

from amprep.geometry.bounding.convex.recursive_cuts import cut_into_cells


@pytest.mark.parametrize("name", ["angle", "ring", "open box", "spiral", "drilled"])
def test_cells_fill_the_solid_without_overlap(name):
    solid = SOLIDS[name]()
    cells = cut_into_cells(solid, 20, 0.0, 0.0, lambda: False)
    assert len(cells) > 1
    assert sum(cell.solid.volume() for cell in cells) == pytest.approx(solid.volume())
    union = Manifold.batch_boolean([cell.solid for cell in cells], OpType.Add)
    assert union.volume() == pytest.approx(solid.volume())


def test_cutting_ends_at_the_number_of_cells_or_at_the_excess():
    ring = SOLIDS["ring"]()
    few = cut_into_cells(ring, 4, 0.0, 0.0, lambda: False)
    assert 4 <= len(few) <= 6
    enough = cut_into_cells(ring, 999, 0.1 * ring.volume(), 0.0, lambda: False)
    assert sum(cell.excess for cell in enough) <= 0.1 * ring.volume()
    assert len(enough) < 100


def test_a_convex_solid_and_a_stopped_search_are_not_cut():
    assert len(cut_into_cells(SOLIDS["cube"](), 10, 1e-6, 0.0, lambda: False)) == 1
    assert len(cut_into_cells(SOLIDS["ring"](), 10, 0.0, 0.0, lambda: True)) == 1


def test_an_angle_is_cut_along_its_concave_edge_into_two_exact_cells():
    cells = cut_into_cells(SOLIDS["turned angle"](), 10, 0.1, 0.0, lambda: False)
    assert len(cells) == 2
    assert sum(cell.excess for cell in cells) < 0.1
