"""What of each placed part needs support: overhangs, the part's own settings, blockers and enforcers."""

from typing import NamedTuple

import numpy as np

from amprep.geometry.overhangs.find import find_overhangs
from amprep.geometry.overhangs.regions import Overhangs
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.overhangs.blockers import Marked, mark


class Needs(NamedTuple):
    """What needs support, and the mesh in build coordinates that its indices mean.

    That is the part's own mesh, split finer where the edge of a blocker or enforcer runs through triangles.
    """

    mesh: Mesh
    overhangs: Overhangs


def needs_of(
    placed: PlacedPart,
    *,
    overhang_angle_deg: float,
    least_area: float,
    least_length: float,
    grant_deg: float = 0.0,
) -> Needs:
    """Return what needs support of a placed part.

    The part's own overhang angle comes before the job's; a part with supports switched off needs none.
    Blockers take away what lies in them, enforcers add what looks down in them. Both angles are lowered by
    `grant_deg`.
    """
    own, mesh = placed.part.overrides, placed.mesh
    angle = overhang_angle_deg if own.overhang_angle_deg is None else own.overhang_angle_deg
    marked = Marked(mesh, None)
    if own.supports is False:
        mesh = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
    else:
        marked = mark(mesh, placed.part.regions, placed.matrix)
        mesh = marked.mesh
    overhangs = find_overhangs(
        mesh.vertices,
        mesh.triangles,
        angle_deg=angle - grant_deg,
        least_area=least_area,
        least_length=least_length,
        marks=marked.marks,
    )
    return Needs(marked.mesh, overhangs)
