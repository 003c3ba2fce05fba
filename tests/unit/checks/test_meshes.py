"""The judge of mesh readers finds every broken part of their promise."""

from dataclasses import replace

import numpy as np
import pytest

from amprep.checks.meshes import check_part
from amprep.model import Mesh, Part
from amprep.model.part import Appearance, Region
from amprep.testing.problems import box_mesh

CUBE = box_mesh(np.zeros(3), np.full(3, 2.0))
PART = Part("cube", CUBE, 8.0)
INSIDE_OUT = Mesh(CUBE.vertices, CUBE.triangles[:, ::-1])


def test_a_closed_cube_of_its_volume_keeps_the_promise():
    assert check_part(PART) == []


@pytest.mark.parametrize(
    ("change", "promise"),
    [
        ({"mesh": Mesh(np.where(CUBE.vertices == 2.0, np.nan, CUBE.vertices), CUBE.triangles)}, "mesh"),
        ({"mesh": Mesh(CUBE.vertices, np.zeros((0, 3), np.int32))}, "mesh"),
        ({"mesh": Mesh(CUBE.vertices, CUBE.triangles[1:])}, "solid"),
        ({"mesh": INSIDE_OUT}, "orientation"),
        ({"volume_mm3": 7.9}, "volume"),
        ({"regions": (Region("blocker", "r", np.array([0, 12])),)}, "regions"),
        ({"appearance": Appearance(triangle_colours=np.zeros((11, 3), np.int64))}, "colours"),
    ],
)
def test_each_broken_promise_is_found(change, promise):
    assert promise in [violation.promise for violation in check_part(replace(PART, **change))]


def test_an_open_mesh_that_does_not_claim_to_be_solid_is_no_fault():
    assert check_part(replace(PART, mesh=Mesh(CUBE.vertices, CUBE.triangles[1:]), is_solid=False)) == []
