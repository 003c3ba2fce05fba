"""An item is called too large only where no position in an empty build exists."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold
from tests.shared.examples import examples
from tests.shared.solids import volume_of_solid

from amprep.checks.packing.volumes_placed import check_packing
from amprep.measures.too_large import proved_too_large
from amprep.model import (
    Boxes,
    BuildVolume,
    Item,
    Orientations,
    Packing,
    PackingProblem,
    Placement,
)


def block(x, y, z):
    return volume_of_solid(Manifold.cube([x, y, z]))


def one_item(volume, size, allowed=None, shape="box", zones=(), **rules):
    corners = np.array(zones, float).reshape(-1, 6)
    space = BuildVolume(np.array(size, float), shape, corners[:, :3], corners[:, 3:])
    return PackingProblem((Item(0, 0, volume, 1.0, allowed or Orientations()),), space, **rules)


def about_z(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize(
    ("volume", "allowed", "size", "expected"),
    [
        (block(10, 4, 4), Orientations(), (10, 10, 10), False),
        (block(10.1, 4, 4), Orientations(), (10, 10, 10), True),
        (block(13, 1, 1), Orientations("about-z"), (10, 10, 10), False),
        (block(13, 12, 1), Orientations("about-z"), (10, 14, 10), True),
        (block(1, 1, 11), Orientations("about-z"), (10, 10, 10), True),
        (block(1, 1, 11), Orientations("free"), (10, 10, 10), False),
        (block(1, 1, 18), Orientations("free"), (10, 10, 10), True),
    ],
)
def test_size_decides_without_zones(volume, allowed, size, expected):
    assert bool(proved_too_large(one_item(volume, size, allowed), [0])) is expected


def test_a_round_part_as_large_as_a_round_plate_is_not_too_large():
    cylinder = volume_of_solid(Manifold.cylinder(20.0, 15.0, 15.0, 200))
    assert not proved_too_large(one_item(cylinder, (30, 30, 20), shape="cylinder"), [0])
    assert proved_too_large(one_item(block(30, 30, 5), (30, 30, 20), shape="cylinder"), [0])


def test_beside_a_zone_only_upright_boxes_are_proved_too_large():
    zone = [(20, 20, 0, 40, 40, 40)]
    prism = volume_of_solid(Manifold.extrude(CrossSection([[(0, 0), (30, 0), (0, 30)]]), 30.0))
    assert not proved_too_large(one_item(prism, (30, 30, 30), zones=zone), [0])
    box = Boxes(np.zeros(3), np.full(3, 30.0))
    assert proved_too_large(one_item(box, (30, 30, 30), zones=zone), [0])
    tilted = Orientations(matrices=about_z(0.3)[None])
    assert not proved_too_large(
        one_item(Boxes(np.zeros(3), np.full(3, 15.0)), (30, 30, 30), tilted, zones=zone), [0]
    )


@examples(60)
@given(seed=st.integers(0, 10**6), shape=st.sampled_from(["box", "cylinder"]))
def test_what_the_judge_accepts_is_never_called_too_large(seed, shape):
    rng = np.random.default_rng(seed)
    volume = volume_of_solid(Manifold.hull_points(rng.uniform(0.0, 10.0, (8, 3))))
    rotation = about_z(rng.uniform(0.0, 6.0))
    points = volume.mesh.vertices @ rotation.T
    size = np.ptp(points, axis=0)
    if shape == "cylinder":
        size[:2] = 2.0 * np.linalg.norm(points[:, :2] - points[:, :2].mean(axis=0), axis=1).max()
        shift = size[:2] / 2.0 - points[:, :2].mean(axis=0)
    else:
        shift = -points[:, :2].min(axis=0)
    placement = Placement(0, rotation, np.array([*shift, -points[:, 2].min()]))
    for allowed in (Orientations(matrices=rotation[None]), Orientations("about-z"), Orientations("free")):
        problem = one_item(volume, size, allowed, shape)
        assert check_packing(problem, Packing(((placement,),))) == []
        assert not proved_too_large(problem, [0])
