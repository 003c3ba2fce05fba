"""Make small spheres that mark points in pictures."""

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.model import Mesh

MOST_MARKS = 400
"""Largest number of marks of one region; they show where it is, not how large it is."""

MARK_MM = (0.6, 0.9)
"""Smallest and largest radius of a mark."""


def mark_radius(reach: float, minimum: float = MARK_MM[0]) -> float:
    """Return the radius of the marks of a region whose points represent `reach` mm around them, at least `minimum`."""
    return max(min(reach, MARK_MM[1]), minimum)


def thinned(points: Floats) -> Floats:
    """Return at most `MOST_MARKS` of the points, at regular intervals."""
    return points[:: max(1, -(-len(points) // MOST_MARKS))]


def balls(centres: Floats, radii: Floats) -> Mesh:
    """Return one mesh of coarse spheres with centres ``(n, 3)`` mm and radii ``(n,)`` mm."""
    vertices, triangles = _octahedron_twice()
    spread = centres[:, None, :] + radii[:, None, None] * vertices[None]
    shifts = len(vertices) * np.arange(len(centres))
    return Mesh(spread.reshape(-1, 3), (triangles[None] + shifts[:, None, None]).reshape(-1, 3))


def _octahedron_twice() -> tuple[Floats, Ints]:
    """Return vertices and triangles of an octahedron with each face split in four, on the unit sphere."""
    corners = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float64)
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (1, 0, 5), (2, 1, 5), (3, 2, 5), (0, 3, 5)]
    points: list[Floats] = []
    for a, b, c in faces:
        middles = [corners[a] + corners[b], corners[b] + corners[c], corners[c] + corners[a]]
        points += [corners[a], corners[b], corners[c], *(middle / np.sqrt(2.0) for middle in middles)]
    split = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]], np.int32)
    distinct, index = np.unique(np.round(points, 12), axis=0, return_inverse=True)
    triangles = np.concatenate([split + 6 * k for k in range(len(faces))])
    return distinct, index.reshape(-1)[triangles].astype(np.int32)
