"""Find the overhangs of a mesh: faces, knife edges and tips (thesis 3.1)."""

import numpy as np

from amprep.arrays import Floats, Int32s
from amprep.geometry.overhangs.candidates import Modifiers, find_candidates
from amprep.geometry.overhangs.regions import (
    Overhangs,
    components_of_edges,
    components_of_faces,
    labelled_regions,
    large_enough,
)
from amprep.geometry.overhangs.surface import ON_PLATE, cross_products


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
    found = find_candidates(vertices, triangles, angle_deg, modifiers, plate=ON_PLATE)
    surface, minimum, sharp, overhanging = found.surface, found.minimum, found.sharp, found.faces
    faces = np.flatnonzero(overhanging)
    area = 0.5 * np.linalg.norm(cross_products(surface.points, surface.triangles[faces]), axis=1)
    face_label = components_of_faces(surface, overhanging)
    starts = np.asarray((minimum[surface.triangles[faces]] >= 0).any(axis=1) | found.enforced[faces])
    face_keep = large_enough(face_label, area, min_area, starts)
    length = np.linalg.norm(surface.points[sharp[:, 1]] - surface.points[sharp[:, 0]], axis=1)
    edge_label = components_of_edges(sharp, len(surface.points))
    edge_keep = large_enough(edge_label, length, min_length, np.asarray((minimum[sharp] >= 0).any(axis=1)))
    return labelled_regions(
        surface,
        (faces[face_keep], face_label[face_keep], area[face_keep]),
        (sharp[edge_keep], edge_label[edge_keep], length[edge_keep]),
        (found.tips, found.tip_label),
    )
