"""Slenderness and density of boxes are known by hand."""

import numpy as np
import pytest

from amprep.measures.density import build_density, build_height, support_volume
from amprep.measures.slenderness import measure_slenderness
from amprep.model import Build, BuildSettings, BuildVolume, Mesh, Part, PlacedPart, SupportBody
from amprep.model.mesh import join_meshes
from amprep.testing.problems import box_mesh

WIDE, TALL = box_mesh((0, 0, 0), (4, 8, 8)), box_mesh((20, 0, 0), (21, 3, 10))


def body(*meshes, **more):
    return SupportBody("supports", join_meshes(meshes), (0,), **more)


def test_the_most_slender_component_counts():
    found = measure_slenderness(body(WIDE, TALL))
    assert found.pieces == 2
    assert found.slenderness == pytest.approx(10.0)
    assert (found.height_mm, found.width_mm) == pytest.approx((10.0, 1.0))
    assert found.position_mm == pytest.approx((20.5, 1.5, 5.0))


def test_voids_and_empty_bodies_are_no_components():
    void = box_mesh((1, 1, 1), (2, 2, 7))
    hollow = body(WIDE, Mesh(void.vertices, void.triangles[:, ::-1]))
    assert measure_slenderness(hollow).pieces == 1
    empty = SupportBody("none", Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32)), (0,))
    assert measure_slenderness(empty).pieces == 0


def test_density_is_the_volume_of_the_parts_over_plate_and_height():
    part = PlacedPart("block", Part("block", box_mesh((0, 0, 0), (10, 10, 10)), 1000.0), np.eye(4))
    for shape, plate in (("box", 400.0), ("cylinder", np.pi * 100.0)):
        settings = BuildSettings("none", BuildVolume(np.array([20.0, 20.0, 30.0]), shape=shape), reach=1.5)
        build = Build(settings, (part,), (body(WIDE),))
        assert build_height(build) == pytest.approx(10.0)
        assert build_density(build) == pytest.approx(1000.0 / (plate * 10.0))
        assert support_volume(build) == pytest.approx(256.0)
