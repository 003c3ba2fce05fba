"""Find the overhangs of a mesh: faces, knife edges and tips (thesis 3.1)."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int32s
from amprep.geometry.overhangs.faces import overhanging_faces
from amprep.geometry.overhangs.knife_edges import knife_edges
from amprep.geometry.overhangs.regions import (
    Overhangs,
    components_of_edges,
    components_of_faces,
    labelled_regions,
    large_enough,
)
from amprep.geometry.overhangs.surface import LEVEL, above_plate, cross_products, merge_vertices, unit_normals
from amprep.geometry.overhangs.tips import minimum_plateaus, tips_of


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


def find_overhangs(
    vertices: Floats,
    triangles: Int32s,
    *,
    angle_deg: float,
    min_area: float = 0.0,
    min_length: float = 0.0,
    modifiers: Modifiers | None = None,
) -> Overhangs:
    """Find the overhangs of a mesh that is built upwards from the plate z = 0 (thesis 3.1).

    A face is an overhang if it faces downwards and its angle to the plate is below `angle_deg`. An edge is a knife
    edge if its own angle is below `angle_deg`, the solid is above it, all its faces rise from it, and none of
    them is an overhang. A tip is a local minimum of the solid that touches neither. Angles within 0.01 degrees
    of the threshold count as steep enough. Geometry on the plate (z <= 0.001 mm) is no overhang.

    Smaller and shorter regions than asked are dropped, unless they contain a local minimum, where the part would
    start in the air, or an enforced triangle. Tips are local minima and never dropped.

    Parameters
    ----------
    vertices
        ``(n, 3)`` mm, in build coordinates. Coincident vertices are merged for the search; the indices returned
        refer to the arrays given.
    triangles
        ``(m, 3)``, normals out of the solid. Edges of one or of more than two faces are allowed.
    angle_deg
        Overhang angle.
    min_area, min_length
        Smallest area (mm2) of a face region and smallest length (mm) of an edge region.
    modifiers
        Triangles and vertices selected by blockers and enforcers.
    """
    surface = merge_vertices(np.asarray(vertices, np.float64), np.asarray(triangles))
    normals = unit_normals(surface)
    minimum = minimum_plateaus(surface)
    overhanging = overhanging_faces(surface, normals, angle_deg)
    sharp = surface.edges[knife_edges(surface, normals, overhanging, angle_deg)]
    tips, tip_label = tips_of(minimum, surface.triangles[overhanging], sharp)

    enforced = np.zeros(len(triangles), np.bool_)
    if modifiers is not None:
        enforced = modifiers.enforced & (normals[:, 2] < -LEVEL) & above_plate(surface)
        overhanging = (overhanging | enforced) & ~modifiers.blocked
        blocked = modifiers.blocked_vertices[surface.first]
        sharp = sharp[~blocked[sharp].all(axis=1)]
        tips, tip_label = tips[~blocked[tips]], tip_label[~blocked[tips]]
    faces = np.flatnonzero(overhanging)
    area = 0.5 * np.linalg.norm(cross_products(surface.points, surface.triangles[faces]), axis=1)
    face_label = components_of_faces(surface, overhanging)
    starts = np.asarray((minimum[surface.triangles[faces]] >= 0).any(axis=1) | enforced[faces])
    face_keep = large_enough(face_label, area, min_area, starts)
    length = np.linalg.norm(surface.points[sharp[:, 1]] - surface.points[sharp[:, 0]], axis=1)
    edge_label = components_of_edges(sharp, len(surface.points))
    edge_keep = large_enough(edge_label, length, min_length, np.asarray((minimum[sharp] >= 0).any(axis=1)))
    return labelled_regions(
        surface,
        (faces[face_keep], face_label[face_keep], area[face_keep]),
        (sharp[edge_keep], edge_label[edge_keep], length[edge_keep]),
        (tips, tip_label),
    )
