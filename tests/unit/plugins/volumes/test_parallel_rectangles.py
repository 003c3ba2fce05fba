from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from scipy.spatial.transform import Rotation
from tests.shared.coverings import part_of

from amprep.checks.volumes import check_volume
from amprep.model import Boxes, Orientations, Stop
from amprep.model.bounding_volume import as_turned
from amprep.plugins.volumes.parallel_rectangles import two_rectangles
from amprep.plugins.volumes.params import TwoRectanglesParams


def angle():
    return Manifold.cube([40, 8, 5]) + Manifold.cube([10, 30, 20])


VOLUME = 30 * 8 * 5 + 10 * 30 * 20


def boxes_around(solid, orientations, objective="union"):
    part = replace(part_of(solid), orientations=orientations)
    made = two_rectangles(
        part, params=TwoRectanglesParams(objective), rng=np.random.default_rng(0), stop=Stop()
    )
    assert check_volume(part, made) == []
    boxes = as_turned(made).volume
    assert isinstance(boxes, Boxes)
    return made, np.prod(boxes.hi - boxes.lo, axis=1)


@pytest.mark.parametrize("freedom", ["about-z", "free"])
def test_a_part_that_may_be_rotated_is_covered_without_waste(freedom):
    made, volumes = boxes_around(angle().rotate([0, 0, 28]), Orientations(freedom))
    assert volumes.sum() == pytest.approx(VOLUME, rel=1e-4)
    assert made.rotation[2].tolist() == [0, 0, 1]


def test_a_part_that_may_not_be_rotated_is_covered_as_it_is():
    made, volumes = boxes_around(angle(), Orientations())
    assert isinstance(made, Boxes)
    assert volumes.sum() == pytest.approx(VOLUME, rel=1e-4)
    assert boxes_around(angle().rotate([0, 0, 28]), Orientations())[1].sum() > 1.2 * VOLUME


def test_of_a_list_the_best_orientation_is_chosen():
    turns = Rotation.from_euler("z", [[0], [-28], [15]], degrees=True).as_matrix()
    made, volumes = boxes_around(angle().rotate([0, 0, 28]), Orientations("list", turns))
    assert volumes.sum() == pytest.approx(VOLUME, rel=1e-4)
    assert np.abs(made.rotation - turns[1]).max() < 1e-12


def test_the_larger_rectangle_counts_if_it_is_asked_for():
    bar = Manifold.cube([40, 8, 5]).rotate([0, 0, 28])
    _, volumes = boxes_around(bar, Orientations("about-z"), "larger")
    assert volumes.max() == pytest.approx(800, rel=0.02)
    assert volumes.sum() == pytest.approx(1600, rel=0.02)
