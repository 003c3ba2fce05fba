"""Bounding volume of two to four boxes, by branch and cut on cells (thesis 2.3)."""

import numpy as np

from amprep.geometry.bounding.boxes.covering import BoxCover, CoverSearch, cover_mesh
from amprep.geometry.bounding.boxes.fit import seal
from amprep.model.bounding_volume import Boxes, TurnedVolume
from amprep.model.control import Stop
from amprep.model.part import Part
from amprep.plugins.volumes.params import BranchAndCutParams


def cover_part(part: Part, params: BranchAndCutParams, rng: np.random.Generator, stop: Stop) -> BoxCover:
    """Cover a part; the result also has the bound of branch and cut and its gap."""
    search = CoverSearch(params.boxes, params.cells, params.work)
    return cover_mesh(part.mesh.vertices, part.mesh.triangles, search, rng=rng, stop=stop)


def branch_and_cut_boxes(
    part: Part, *, params: BranchAndCutParams, rng: np.random.Generator, stop: Stop
) -> TurnedVolume:
    """Return boxes that contain the part, with bound and gap; the best so far if `stop` becomes true."""
    cover = cover_part(part, params, rng, stop)
    boxes = seal(cover.boxes)
    return TurnedVolume(Boxes(boxes[:, :3], boxes[:, 3:]), np.eye(3), cover.bound, cover.gap)
