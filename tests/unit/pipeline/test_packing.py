"""An item is exact when the packer gets the part itself in all its orientations; a bound is then one for the parts."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.hookspecs import PackerAccepts
from amprep.job import PackingSettings
from amprep.model import Boxes, BuildVolume, Orientations, Part, Solid
from amprep.model.bounding_volume import as_turned
from amprep.model.mesh import Mesh
from amprep.pipeline.packing import packing_problem

BLOCK = box_mesh((0, 0, 0), (30, 20, 10))
WEDGE = Mesh(
    np.array([[0, 0, 0], [30, 0, 0], [0, 20, 0], [0, 0, 10.0]]),
    np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)
LISTS = PackerAccepts(orientations=frozenset({"fixed", "axis", "list"}))


def enclosing_box(mesh):
    return Boxes(*(corner[None] for corner in mesh.bounds))


@pytest.mark.parametrize(
    ("mesh", "volume", "freedom", "exact"),
    [
        (WEDGE, Solid(WEDGE), "list", True),
        (WEDGE, Solid(Mesh(WEDGE.vertices, WEDGE.triangles)), "list", False),
        (WEDGE, enclosing_box(WEDGE), "list", False),
        (BLOCK, enclosing_box(BLOCK), "list", True),
        (WEDGE, Solid(WEDGE), "free", False),
        (WEDGE, Solid(WEDGE), "about-z", False),
    ],
)
def test_a_bound_is_for_the_parts_if_volumes_and_orientations_are_those_of_the_parts(
    mesh, volume, freedom, exact
):
    part = Part("part", mesh, mesh.signed_volume, quantity=2, orientations=Orientations(freedom))
    space = BuildVolume(np.array([100.0, 100.0, 100.0]))
    problem = packing_problem([part], [as_turned(volume)], space, PackingSettings(), LISTS)
    assert [item.exact for item in problem.items] == [exact, exact]
    assert problem.bound_for == ("shapes" if exact else "volumes")
