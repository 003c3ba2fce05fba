"""The value that a packing reaches, and its gap to the bound."""

import numpy as np
import pytest

from amprep.measures.objective import objective_reached, relative_gap
from amprep.model import Boxes, BuildVolume, Item, Packing, PackingProblem, Placement, Unplaced

ROD = Boxes([[0, 0, 0]], [[30, 10, 10]])
UPRIGHT = np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])
ITEMS = (Item(0, 0, ROD, 5.0), Item(0, 1, ROD, 5.0), Item(1, 0, ROD, 2.0))
PACKING = Packing(
    ((Placement(0, np.eye(3), [0, 0, 0]), Placement(2, UPRIGHT, [20, 20, 3])),),
    (Unplaced(1, "no room left"),),
)


@pytest.mark.parametrize(("objective", "expected"), [("builds", 1), ("fill", 7.0), ("height", 33.0)])
def test_the_objective_is_builds_value_or_the_top_of_the_highest_turned_volume(objective, expected):
    problem = PackingProblem(ITEMS, BuildVolume([100, 100, 100]), objective)
    assert objective_reached(problem, PACKING) == pytest.approx(expected)


def test_an_empty_packing_reaches_nothing():
    problem = PackingProblem(ITEMS, BuildVolume([100, 100, 100]), "height")
    assert objective_reached(problem, Packing(())) == 0.0


def test_the_gap_is_the_possible_improvement_relative_to_what_was_reached():
    assert relative_gap("fill", 80.0, 100.0) == pytest.approx(0.25)
    assert relative_gap("height", 100.0, 80.0) == pytest.approx(0.2)
    assert relative_gap("builds", 3.0, 3.0) == 0.0
    assert relative_gap("fill", 100.0, 100.0 - 1e-12) == 0.0, "rounding is no gap"
    assert relative_gap("fill", 80.0, None) is None
    assert relative_gap("fill", 0.0, 10.0) is None
