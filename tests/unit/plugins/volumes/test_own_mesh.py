"""The mesh of the part as its bounding volume."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.errors import MeshError
from amprep.hookspecs import NoParams
from amprep.model import Part, Stop
from amprep.plugins.volumes.own_mesh import own_mesh

CUBE = Part("cube", box_mesh((0, 0, 0), (10, 10, 10)), 1000.0)


def bound(part):
    return own_mesh(part, params=NoParams(), rng=np.random.default_rng(0), stop=Stop())


def test_the_mesh_of_a_solid_is_its_bounding_volume():
    assert bound(CUBE).mesh is CUBE.mesh


def test_an_open_mesh_is_refused_with_the_maker_to_choose():
    with pytest.raises(
        MeshError, match=r"part 'cube': the volume maker 'mesh' needs a solid.*choose the volume maker 'box'"
    ):
        bound(replace(CUBE, is_solid=False))
