"""Chosen regions keep their faces, edges and tips and their numbers; the others stay touchable, or do not."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.model import Mesh, Part, PlacedPart
from amprep.model.mesh import join_meshes
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.of_part import overhangs_of
from amprep.overhangs.selection import measure_regions, select_regions

SLABS = join_meshes([box_mesh((20.0 * i, 0, 5 + i), (10, 10, 2)) for i in range(3)])
OWN = overhangs_of(PlacedPart("p", Part("p", SLABS, 600.0), np.eye(4)), SupportRules())

_CORNERS = [[40, 0, 10], [41, 0, 18], [40, 1, 18], [39, 0, 18], [40, -1, 18], [40, 0, 26]]
DIAMOND = Mesh(
    _CORNERS, [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [5, 1, 2], [5, 2, 3], [5, 3, 4], [5, 4, 1]]
)


def heights(faces):
    return set(OWN.mesh.vertices[OWN.mesh.triangles[faces], 2].ravel().tolist())


def test_only_the_faces_of_chosen_regions_remain_and_others_may_be_touched():
    every = np.ones(3, np.bool_)
    chosen = every.copy()
    height = [region.centre[2] for region in OWN.overhangs.regions]
    chosen[height.index(6.0)] = False
    found = select_regions(OWN, chosen, every).overhangs
    assert (heights(found.faces), heights(found.beside)) == ({5.0, 7.0}, {6.0})
    assert found.regions == OWN.overhangs.regions
    assert heights(select_regions(OWN, chosen, chosen).overhangs.beside) == set(), "an excepted region"


def test_all_regions_are_the_overhangs_themselves():
    found = select_regions(OWN, np.ones(3, np.bool_), np.ones(3, np.bool_)).overhangs
    for name, value in OWN.overhangs._asdict().items():
        if name != "regions":
            np.testing.assert_array_equal(getattr(found, name), value)


@pytest.mark.parametrize("angle", [0.0, 10.0, 30.0])
def test_angle_and_height_are_measured_of_faces_edges_and_tips(angle):
    turn = np.eye(4)
    cos, sin = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn[:3, :3] = [[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]]
    part = Part("p", join_meshes([box_mesh((0, 0, 5), (10, 10, 2)), DIAMOND]), 300.0)
    placed = PlacedPart("p", part, turn)
    found = measure_regions(overhangs_of(placed, SupportRules())).overhangs.regions
    face, tip = (next(each for each in found if each.kind == kind) for kind in ("face", "tip"))
    assert face.angle_deg == pytest.approx(angle, abs=1e-6)
    assert face.lowest_mm == pytest.approx(5 * cos)
    assert tip.lowest_mm == pytest.approx(placed.mesh.vertices[-6:, 2].min())
    assert tip.angle_deg == 0.0
