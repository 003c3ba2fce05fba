"""Of the struts of a filled region those stay that meet the part and belong to no dropped component."""

import numpy as np

from amprep.infill.beams import lattice_of
from amprep.model import Beams, Mesh
from amprep.testing.problems import box_mesh

PART = box_mesh((0, 0, 0), (10, 10, 10))
NONE = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
NODES = np.array([[5, 5, 2], [5, 5, 8], [9, 5, 5], [14, 5, 5], [20, 5, 5], [25, 5, 5]], float)
BEAMS = Beams(
    NODES, np.array([[0, 1], [2, 3], [4, 5]], np.int32), np.full((3, 2), 0.5), np.zeros(3, np.int32)
)


def test_beams_outside_the_part_are_left_out_with_their_nodes():
    made = lattice_of(BEAMS, PART, NONE, shell=PART, whole=PART)
    assert made.nodes.tolist() == NODES[:4].tolist()
    assert made.struts.tolist() == [[0, 1], [2, 3]]
    assert made.room is None


def test_beams_in_dropped_components_are_left_out():
    dropped = box_mesh((4, 4, 1), (6, 6, 9))
    made = lattice_of(BEAMS, PART, dropped, shell=PART, whole=PART)
    assert made.nodes.tolist() == NODES[2:4].tolist()
