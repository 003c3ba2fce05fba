from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from scipy.spatial.transform import Rotation
from tests.shared.coverings import part_of

from amprep.checks.volumes import check_volume
from amprep.hookspecs import NoParams
from amprep.model import Boxes, Mesh, Orientations, Part, Stop
from amprep.model.bounding_volume import as_turned
from amprep.plugins.volumes.oriented_box import oriented_box


def box_around(solid, orientations):
    part = replace(part_of(solid), orientations=orientations)
    made = oriented_box(part, params=NoParams(), rng=np.random.default_rng(0), stop=Stop())
    assert check_volume(part, made) == []
    box = as_turned(made).volume
    assert isinstance(box, Boxes)
    return made, float(np.prod(box.hi - box.lo))


def rod(*degrees):
    return Manifold.cube([40, 6, 3]).rotate(list(degrees))


def test_a_part_that_may_be_rotated_freely_gets_the_smallest_box():
    assert box_around(rod(20, 30, 40), Orientations("free"))[1] == pytest.approx(720, rel=1e-5)


def test_a_part_that_may_be_rotated_about_z_gets_the_smallest_upright_box():
    assert box_around(rod(0, 0, 33), Orientations("about-z"))[1] == pytest.approx(720, rel=1e-5)
    assert box_around(rod(20, 0, 33), Orientations("about-z"))[1] > 800


def test_of_a_list_the_best_orientation_is_chosen():
    turns = Rotation.from_euler("z", [[0], [-30], [15]], degrees=True).as_matrix()
    made, volume = box_around(rod(0, 0, 30), Orientations("list", turns))
    assert volume == pytest.approx(720, rel=1e-5)
    assert np.abs(made.rotation - turns[1]).max() < 1e-12


@pytest.mark.parametrize("freedom", ["free", "about-z", "list"])
def test_a_part_that_is_a_box_already_is_not_turned(freedom):
    made, volume = box_around(rod(0, 0, 0), Orientations(freedom))
    assert isinstance(made, Boxes)
    assert volume == pytest.approx(720)


def test_a_flat_part_that_may_be_rotated_freely_is_laid_level():
    square = Manifold.cube([30, 20, 0.1]).rotate([20, 30, 40]).to_mesh64()
    corners = square.vert_properties[:3, :3]
    part = Part("flat", Mesh(corners, [[0, 1, 2]]), 0.0, orientations=Orientations("free"), is_solid=False)
    made = oriented_box(part, params=NoParams(), rng=np.random.default_rng(0), stop=Stop())
    assert check_volume(part, made) == []
    assert np.ptp(part.mesh.vertices @ as_turned(made).rotation.T, axis=0)[2] < 1e-9
