"""Find faces, edges and points of a mesh that are overhangs by the overhang angle alone."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.faces import overhanging_faces
from amprep.geometry.overhangs.knife_edges import knife_edges
from amprep.geometry.overhangs.surface import LEVEL, Surface, above_plate, merge_vertices, unit_normals
from amprep.geometry.overhangs.tips import minimum_plateaus, tips_of, without_dips


class Modifiers(NamedTuple):
    """Support modifiers: triangles that must be supported, and triangles and vertices that must not be.

    Attributes
    ----------
    enforced
        ``(m,)`` bool, triangles to support; only downward triangles above the plate count.
    blocked
        ``(m,)`` bool, triangles that are no overhangs.
    blocked_vertices
        ``(n,)`` bool, vertices that are no tips; an edge with two of them is no knife edge.
    """

    enforced: Bools
    blocked: Bools
    blocked_vertices: Bools


class Candidates(NamedTuple):
    """Overhangs of a surface by the overhang angle alone.

    Attributes
    ----------
    surface, normals
        The surface with coincident vertices merged, and its unit normals.
    minimum
        ``(n,)`` plateau of each point that is a local minimum, else -1.
    natural
        ``(m,)`` bool, faces flatter than the overhang angle, whether blocked or not.
    enforced, blocked
        ``(m,)`` bool, faces that need support or none whatever their angle.
    sharp
        ``(e, 2)`` knife edges.
    tips, tip_label
        ``(t,)`` points, and their plateaus.
    """

    surface: Surface
    normals: Floats
    minimum: Int64s
    natural: Bools
    enforced: Bools
    blocked: Bools
    sharp: Int64s
    tips: Int64s
    tip_label: Int64s

    @property
    def faces(self) -> Bools:
        """The faces that are overhangs, with blockers and enforcers."""
        return np.asarray((self.natural | self.enforced) & ~self.blocked)


def find_candidates(
    vertices: Floats,
    triangles: NDArray[Any],
    angle_deg: float,
    modifiers: Modifiers | None,
    *,
    plate: float,
    dip: float = 0.0,
) -> Candidates:
    """Find the overhangs of a mesh by the overhang angle alone.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm in build coordinates, ``(m, 3)``.
    angle_deg
        Overhang angle.
    modifiers
        Triangles and vertices selected by blockers and enforcers.
    plate
        Height (mm) up to which geometry is on the plate.
    dip
        Least depth (mm) of a local minimum.
    """
    surface = merge_vertices(np.asarray(vertices, np.float64), np.asarray(triangles))
    normals = unit_normals(surface)
    minimum = minimum_plateaus(surface, plate)
    if dip > 0:
        minimum = without_dips(surface, minimum, dip)
    natural = overhanging_faces(surface, normals, angle_deg, plate)
    sharp = surface.edges[knife_edges(surface, normals, natural, angle_deg, plate)]
    tips, tip_label = tips_of(minimum, surface.triangles[natural], sharp)
    enforced = blocked = np.zeros(len(triangles), np.bool_)
    if modifiers is not None:
        enforced = modifiers.enforced & (normals[:, 2] < -LEVEL) & above_plate(surface, plate)
        blocked = modifiers.blocked
        points = modifiers.blocked_vertices[surface.first]
        sharp = sharp[~points[sharp].all(axis=1)]
        tips, tip_label = tips[~points[tips]], tip_label[~points[tips]]
    return Candidates(surface, normals, minimum, natural, enforced, blocked, sharp, tips, tip_label)
