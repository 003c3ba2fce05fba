"""Chosen regions keep their faces, edges and tips and their numbers; the others stay touchable, or do not."""

import numpy as np
from tests.shared.builds import box_mesh

from amprep.model import Part, PlacedPart
from amprep.model.mesh import join_meshes
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.of_part import overhangs_of
from amprep.overhangs.selection import select_regions

SLABS = join_meshes([box_mesh((20.0 * i, 0, 5 + i), (10, 10, 2)) for i in range(3)])
OWN = overhangs_of(PlacedPart("p", Part("p", SLABS, 600.0), np.eye(4)), SupportRules())


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
