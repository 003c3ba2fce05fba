from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.coverings import part_of

from amprep.checks.volumes import check_volume
from amprep.model import Boxes, Orientations, Stop
from amprep.model.bounding_volume import TurnedVolume
from amprep.plugins.volumes.k_means import k_means_boxes
from amprep.plugins.volumes.params import KMeansParams


def bounded(freedom, *, rotate=True):
    angle = (Manifold.cube([40, 8, 5]) + Manifold.cube([8, 40, 5])).rotate([0, 0, 28])
    part = replace(part_of(angle), orientations=Orientations(freedom))
    params = KMeansParams(boxes=2, rotate=rotate)
    made = k_means_boxes(part, params=params, rng=np.random.default_rng(0), stop=Stop())
    assert check_volume(part, made) == []
    return made


@pytest.mark.parametrize("freedom", ["about-z", "free"])
def test_a_part_that_may_be_rotated_gets_boxes_in_its_best_orientation(freedom):
    made = bounded(freedom)
    assert isinstance(made, TurnedVolume)
    assert isinstance(made.volume, Boxes)
    volume = np.prod(made.volume.hi - made.volume.lo, axis=1).sum()
    assert volume == pytest.approx(1600 + 1280, rel=1e-3)


def test_a_part_that_may_not_be_rotated_keeps_its_orientation():
    assert isinstance(bounded("list"), Boxes)
    assert isinstance(bounded("free", rotate=False), Boxes)
