"""Every volume maker on offer makes a volume that contains the part as a solid."""

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.checks.volumes import check_volume
from amprep.host import Host
from amprep.model import Mesh, Part, Stop

HOST = Host.load()
MAKERS = sorted(HOST.offers("volume"))

PARTS = {
    "cube": lambda: Manifold.cube([10, 20, 30]),
    "ball": lambda: Manifold.sphere(10, 32),
    "angle": lambda: Manifold.cube([20, 10, 5]) + Manifold.cube([5, 10, 20]),
    "ring": lambda: Manifold.cylinder(5, 20, 20) - Manifold.cylinder(5, 15, 15),
    "hollow": lambda: Manifold.cube([20, 20, 20]) - Manifold.cube([16, 16, 16]).translate([2, 2, 2]),
    "apart": lambda: Manifold.cube([5, 5, 5]) + Manifold.cube([5, 5, 5]).translate([50, 60, 70]),
    "far away": lambda: Manifold.sphere(3, 16).translate([-1000, 2000, 500]),
}


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("name", PARTS)
def test_a_volume_contains_its_part(maker, name):
    solid = PARTS[name]()
    mesh = solid.to_mesh64()
    given = np.array(solid.bounding_box(), float)[None]  # for makers that take boxes given by hand
    part = Part(name, Mesh(mesh.vert_properties[:, :3], mesh.tri_verts), solid.volume(), boxes=given)
    listed = HOST.choose("volume", maker)
    rng = np.random.default_rng(1)
    volume = HOST.call(listed, part, params=HOST.params(listed, {}), rng=rng, stop=Stop())
    assert check_volume(part, volume) == []
