"""What the part itself carries, on shapes whose verdicts are known by construction."""

import manifold3d
import numpy as np
import pytest
from tests.shared.solids import mesh_of

from amprep.geometry.overhangs.carried.points import Limits
from amprep.geometry.overhangs.limited import find_limited_overhangs

Solid = manifold3d.Manifold
TOLERANT = Limits(45.0, 2.0, 4.0, 10.0, 0.06, 0.04)


def box(size, corner=(0, 0, 0)):
    return Solid.cube(size).translate(corner)


def found(solid, limits=TOLERANT):
    mesh = mesh_of(solid)
    return find_limited_overhangs(mesh.vertices, mesh.triangles, limits)


def ledge(length):
    return box((10, 10, 20)) + box((length + 5, 10, 5), (5, 0, 15))


def areas(result, faces):
    a, b, c = np.moveaxis(result.vertices[result.triangles[faces]], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


@pytest.mark.parametrize(("length", "carried"), [(0.2, True), (2.0, True), (2.1, False), (6.0, False)])
def test_a_ledge_is_carried_up_to_its_limit(length, carried):
    (region,) = found(ledge(length)).overhangs.regions
    assert (region.kind, region.is_self_supporting) == ("ledge", carried)
    assert region.size_mm == pytest.approx(length, abs=0.05)


def test_only_what_is_beyond_the_limit_needs_support():
    result = found(ledge(6.0))
    needed = result.overhangs.faces
    assert areas(result, needed).sum() == pytest.approx(40.0, abs=0.3 * 10)
    assert areas(result, np.concatenate([needed, result.overhangs.beside])).sum() == pytest.approx(60.0)
    assert result.vertices[result.triangles[needed], 0].min() > 12.0 - 0.4


def test_the_mesh_that_is_subdivided_at_the_limits_is_still_closed():
    result = found(ledge(6.0))
    assert len(result.triangles) > 24
    solid = manifold3d.Manifold(
        manifold3d.Mesh(result.vertices.astype(np.float32), result.triangles.astype(np.uint32))
    )
    assert solid.status() == manifold3d.Error.NoError
    assert solid.volume() == pytest.approx(2000 + 300, rel=1e-4)
