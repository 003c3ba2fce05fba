import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.coverings import part_of

from amprep.checks.volumes import check_volume
from amprep.model import Mesh, Part, Stop
from amprep.plugins.volumes.params import TwoBoxesParams
from amprep.plugins.volumes.two_boxes import cover_with_two

SURFACES = {
    "one triangle": ([[0, 0, 0], [10, 3, 5], [2, 8, 1]], [[0, 1, 2]]),
    "a level square": ([[0, 0, 5], [10, 0, 5], [10, 10, 5], [0, 10, 5]], [[0, 1, 2], [0, 2, 3]]),
    "a line": ([[0, 0, 0], [5, 5, 5], [10, 10, 10]], [[0, 1, 2]]),
    "a point": ([[1, 2, 3]], [[0, 0, 0]]),
}


def two(part, **params):
    boxes = cover_with_two(part, params=TwoBoxesParams(**params), rng=np.random.default_rng(0), stop=Stop())
    return boxes, np.prod(boxes.hi - boxes.lo, axis=1)


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("objective", ["union", "larger"])
def test_surfaces_that_are_no_solids_are_covered(name, objective):
    vertices, triangles = SURFACES[name]
    part = Part("part", Mesh(np.array(vertices, float), np.array(triangles)), 0.0, is_solid=False)
    boxes, _ = two(part, objective=objective)
    assert check_volume(part, boxes) == []


def test_the_objectives_differ_where_one_large_box_saves_volume():
    part = part_of(Manifold.cube([30, 10, 10]) + Manifold.cube([10, 10, 14]))
    union, larger = two(part)[1], two(part, objective="larger")[1]
    assert union.sum() == pytest.approx(3000 + 400, rel=1e-4)
    assert larger.max() < 2000 < union.max()
