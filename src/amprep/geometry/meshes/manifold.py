"""Conversion of meshes to solids of manifold3d."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from amprep.geometry.meshes.topology import edges_match

if TYPE_CHECKING:
    from manifold3d import Manifold


def as_manifold(vertices: ArrayLike, triangles: ArrayLike) -> "Manifold":
    """Return a mesh as a solid of manifold3d, which is empty if manifold3d rejects the mesh (see `accepted`).

    Indices must be in range. Edges are compared first, because manifold3d 3.5 crashes on some meshes whose edges do not
    match instead of rejecting them.
    """
    from manifold3d import Manifold, Mesh64

    corners = np.array(triangles, np.int64, order="C")
    if len(corners) == 0 or not edges_match(corners):
        return Manifold(Mesh64(np.eye(3), np.array([[0, 1, 2]], np.uint64)))
    points = np.array(vertices, np.float64, order="C")  # a copy: manifold3d takes no read-only arrays
    return Manifold(Mesh64(points, corners.astype(np.uint64)))


def accepted(solid: "Manifold") -> bool:
    """Tell whether manifold3d accepted the mesh."""
    from manifold3d import Error

    return bool(solid.status() == Error.NoError)
