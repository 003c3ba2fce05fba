"""Density of boxes is known by hand."""

import numpy as np
import pytest

from amprep.measures.density import build_density, build_height, support_volume
from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart, SupportBody
from amprep.testing.problems import box_mesh

WIDE = box_mesh((0, 0, 0), (4, 8, 8))


def test_density_is_the_volume_of_the_parts_over_plate_and_height():
    part = PlacedPart("block", Part("block", box_mesh((0, 0, 0), (10, 10, 10)), 1000.0), np.eye(4))
    for shape, plate in (("box", 400.0), ("cylinder", np.pi * 100.0)):
        settings = BuildSettings("none", BuildVolume(np.array([20.0, 20.0, 30.0]), shape=shape), reach=1.5)
        build = Build(settings, (part,), (SupportBody("supports", WIDE, (0,)),))
        assert build_height(build) == pytest.approx(10.0)
        assert build_density(build) == pytest.approx(1000.0 / (plate * 10.0))
        assert support_volume(build) == pytest.approx(256.0)
