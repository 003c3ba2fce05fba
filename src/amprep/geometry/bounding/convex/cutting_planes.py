"""Planes along which a solid may be cut into more convex cells."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.bounding.convex.cells import CutCell

LEAST_ANGLE = np.radians(10.0)
"""Concave edges flatter than this are the facets of a curved surface; their planes are no candidates."""

CONCAVE = 10
"""Largest number of candidates along faces at concave edges."""

OFFSET = 1e-6
"""Distance of a candidate from its face, as a fraction of the size of the part.

A cut exactly in a face would leave films on the other side, because faces that should be in one plane are not.
"""


class ConcaveFaces(NamedTuple):
    """Planes of the faces at concave edges of a solid, one row for each side of each edge.

    Attributes
    ----------
    planes
        ``(k, 4)``, outward unit normals and offsets.
    weight
        ``(k,)`` mm: length of the edge times the squared sine of its angle.
    middle
        ``(k, 3)`` mm, middle of the edge.
    """

    planes: Floats
    weight: Floats
    middle: Floats


def concave_faces(vertices: Floats, triangles: Int64s) -> ConcaveFaces:
    """Return the planes of the faces at the concave edges of a closed mesh."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    face = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort((start, np.maximum(start, end), np.minimum(start, end)))
    one, two = order[:-1:2], order[1::2]
    twins = (start[one] == end[two]) & (end[one] == start[two])
    one, two = one[twins], two[twins]
    corners = vertices[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    normal = normal / np.where(length > 0.0, length, 1.0)[:, None]
    first, second = face[one], face[two]
    across = corners[second].sum(axis=1) - vertices[start[one]] - vertices[end[one]]
    sine = np.linalg.norm(np.cross(normal[first], normal[second]), axis=1)
    rises = np.einsum("ij,ij->i", normal[first], across - vertices[start[one]]) > 0.0
    concave = rises & (sine > np.sin(LEAST_ANGLE))
    a, b = vertices[start[one[concave]]], vertices[end[one[concave]]]
    normals = np.concatenate((normal[first[concave]], normal[second[concave]]))
    middle = np.tile((a + b) / 2, (2, 1))
    weight = np.tile(np.linalg.norm(b - a, axis=1) * sine[concave] ** 2, 2)
    return ConcaveFaces(np.column_stack((normals, np.einsum("ij,ij->i", normals, middle))), weight, middle)


def candidate_planes(
    cell: CutCell, faces: ConcaveFaces, size: float, sections: int
) -> list[tuple[Floats, float]]:
    """Return candidate planes (unit normal, offset) that cut a cell.

    Parameters
    ----------
    cell
        The cell.
    faces
        The concave faces of the whole part.
    size
        Diagonal of the bounding box of the part, mm.
    sections
        Number of candidates normal to each axis.
    """
    lo, hi = cell.vertices.min(axis=0), cell.vertices.max(axis=0)
    fractions = (np.arange(sections) + 1.0) / (sections + 1.0)
    found = [(np.eye(3)[k], float(lo[k] + t * (hi[k] - lo[k]))) for k in range(3) for t in fractions]
    near = 1e-6 * size
    inside = ((faces.middle > lo + near) & (faces.middle < hi - near)).sum(axis=1) >= 2
    inside &= ((faces.middle >= lo - near) & (faces.middle <= hi + near)).all(axis=1)
    for normal, offset in _heaviest(faces.planes[inside], faces.weight[inside], size):
        height = cell.corners @ normal - offset
        if height.min() < -near and height.max() > near:
            found.append((normal, offset))
    return found


def _heaviest(planes: Floats, weight: Floats, size: float) -> list[tuple[Floats, float]]:
    """Return the planes of greatest total weight, moved outward by `OFFSET`."""
    if len(planes) == 0:
        return []
    key = np.round(planes / np.array([1.0, 1.0, 1.0, 0.1 * size]), 4)
    _, first, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
    total = np.bincount(which.ravel(), weight)
    chosen = first[np.argsort(-total, kind="stable")[:CONCAVE]]
    return [(planes[k, :3], float(planes[k, 3] + OFFSET * size)) for k in chosen]
