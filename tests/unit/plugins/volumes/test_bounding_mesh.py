"""The volume maker `bounding-mesh`: a closed mesh of few triangles that contains the part."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import PRINTABLE, mesh_of

from amprep.checks.volumes import check_volume
from amprep.errors import MeshError
from amprep.model import Mesh, Part, Stop
from amprep.plugins.volumes.bounding_mesh import bounding_mesh
from amprep.plugins.volumes.params import BoundingMeshParams

pytestmark = pytest.mark.compiled

RNG = np.random.default_rng(1)


def part_of(solid):
    return Part("part", mesh_of(solid), solid.volume())


def make(part, stop=None, **params):
    return bounding_mesh(part, params=BoundingMeshParams(**params), rng=RNG, stop=stop or Stop())


@pytest.mark.parametrize("name", PRINTABLE)
def test_the_judge_accepts_the_volume(name):
    part = part_of(PRINTABLE[name]())
    volume = make(part, fraction=0.1)
    assert check_volume(part, volume) == []
    assert len(volume.mesh.triangles) < len(part.mesh.triangles)


def test_triangles_and_fraction_set_the_target():
    part = part_of(Manifold.sphere(10, 64))
    assert len(make(part, triangles=100).mesh.triangles) == 100
    assert len(make(part, fraction=0.25).mesh.triangles) == len(part.mesh.triangles) // 4


def test_the_distance_is_limited():
    part = part_of(Manifold.sphere(10, 64))
    volume = make(part, fraction=0.0, max_error_mm=0.5)
    assert np.linalg.norm(volume.mesh.vertices, axis=1).max() <= 10.5


@pytest.mark.parametrize("name", ["screw plate", "gear", "thin box"])
def test_where_the_target_is_missed_the_volume_is_no_larger_than_the_simplified_hull(name):
    solid = PRINTABLE[name]()
    volume, convex = make(part_of(solid), triangles=20), make(part_of(solid.hull()), triangles=20)
    assert check_volume(part_of(solid), volume) == []
    missed = len(volume.mesh.triangles) > 20
    assert not missed or volume.mesh.signed_volume <= convex.mesh.signed_volume * (1 + 1e-9)


def test_after_a_stop_the_volume_contains_the_part():
    part = part_of(Manifold.sphere(10, 256))
    volume = make(part, Stop.after(0.0), triangles=50)
    assert check_volume(part, volume) == []


def test_an_open_mesh_is_refused():
    part = Part("flap", Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), 0.0, is_solid=False)
    with pytest.raises(MeshError, match=r"'flap'.*needs a solid"):
        make(part)
