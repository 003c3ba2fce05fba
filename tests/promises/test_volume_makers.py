"""Every volume maker on offer makes a volume that contains the part as a solid."""

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from scipy.spatial.transform import Rotation

from amprep.checks.volumes import check_volume
from amprep.errors import MeshError
from amprep.host import Host
from amprep.model import Boxes, ConvexPieces, Mesh, Orientations, Part, Stop
from amprep.model.bounding_volume import as_turned

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


ORIENTATIONS = {
    "a list without the identity": Orientations(
        "list", Rotation.from_euler("x", [[90], [37]], degrees=True).as_matrix()
    ),
    "about z": Orientations("about-z"),
    "free": Orientations("free"),
}

SURFACES = {
    "triangle": ([[0, 0, 0], [10, 1, 2], [3, 9, 7]], [[0, 1, 2]]),
    "level square": ([[0, 0, 5], [10, 0, 5], [10, 10, 5], [0, 10, 5]], [[0, 1, 2], [0, 2, 3]]),
    "upright square": ([[0, 0, 0], [10, 0, 0], [10, 0, 10], [0, 0, 10]], [[0, 1, 2], [0, 2, 3]]),
    "line": ([[0, 0, 0], [10, 0, 0], [5, 0, 0]], [[0, 1, 2]]),
    "point": ([[1, 1, 1]] * 3, [[0, 1, 2]]),
}


def part_of(name, solid):
    mesh = solid.to_mesh64()
    given = np.array(solid.bounding_box(), float)[None]  # for makers that take boxes given by hand
    return Part(name, Mesh(mesh.vert_properties[:, :3], mesh.tri_verts), solid.volume(), boxes=given)


def made(maker, part):
    listed = HOST.choose("volume", maker)
    rng = np.random.default_rng(1)
    return HOST.call(listed, part, params=HOST.params(listed, {}), rng=rng, stop=Stop())


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("name", PARTS)
def test_a_volume_contains_its_part(maker, name):
    part = part_of(name, PARTS[name]())
    assert check_volume(part, made(maker, part)) == []


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("allowed", ORIENTATIONS)
def test_a_volume_is_turned_only_as_its_part_allows(maker, allowed):
    turned = PARTS["angle"]().rotate([10, 20, 30])
    part = replace(part_of(allowed, turned), orientations=ORIENTATIONS[allowed])
    assert check_volume(part, made(maker, part)) == []


def numbers_of(made):
    turned = as_turned(made)
    volume = turned.volume
    if isinstance(volume, Boxes):
        return turned.rotation.tolist(), volume.lo.tolist(), volume.hi.tolist()
    pieces = volume.pieces if isinstance(volume, ConvexPieces) else (volume.mesh,)
    return turned.rotation.tolist(), [piece.digest for piece in pieces]


@pytest.mark.parametrize("maker", MAKERS)
def test_the_same_part_and_seed_give_the_same_volume(maker):
    solid = (PARTS["angle"]() + PARTS["ball"]()).rotate([10, 20, 30])
    part = replace(part_of("part", solid), orientations=ORIENTATIONS["free"])
    assert numbers_of(made(maker, part)) == numbers_of(made(maker, part))


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("allowed", ORIENTATIONS)
@pytest.mark.parametrize("name", SURFACES)
def test_a_part_that_is_no_solid_is_contained_or_refused_with_the_maker_to_choose(maker, name, allowed):
    mesh = Mesh(np.array(SURFACES[name][0], float), np.array(SURFACES[name][1]))
    given = np.array([[-1, -1, -1, 11, 11, 11]], float)
    part = Part(name, mesh, 0.0, orientations=ORIENTATIONS[allowed], is_solid=False, boxes=given)
    try:
        faults = [fault.message for fault in check_volume(part, made(maker, part))]
    except MeshError as error:
        faults = [] if "choose the volume maker 'box'" in str(error) else [str(error)]
    assert faults == []
