"""Graphs and conditions that are impossible are refused."""

import numpy as np
import pytest
from tests.shared.cells import PIN

from amprep.model import (
    GraphCell,
    When,
)


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"struts": [[0, 2]]}, "struts must refer to points 0 to 1"),
        ({"struts": [[0, 0]]}, "a strut must join two different points"),
        ({"points": [[0, 0, 0], [0, 0, 1.1]]}, "points must be inside the unit cube"),
        ({"radius": 0.0}, "radii must be above 0"),
        ({"struts": np.empty((0, 2))}, "a graph must have struts or faces"),
        ({"growth": 0.5}, "growth must be between 1 and 10"),
        ({"full_load": 1}, "full_load must be at least 2"),
    ],
)
def test_a_graph_without_sense_is_refused(wrong, reason):
    with pytest.raises(ValueError, match=reason):
        GraphCell(**{"points": PIN.points, "struts": PIN.struts, **wrong})


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"roles": {"roof"}}, "roles must be among trunk, surface, foot, connector"),
        ({"edges": "up"}, "edges must be one of any, straight, oblique"),
        ({"least_load": 3, "most_load": 2}, "least_load must be at most most_load"),
        ({"every": 0}, "every must be at least 1"),
        ({"every": 2, "layer": 2}, "layer must be at least 0 and below every"),
    ],
)
def test_a_condition_without_sense_is_refused(wrong, reason):
    with pytest.raises(ValueError, match=reason):
        When(**wrong)
