"""Meshes as manifold3d takes them."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from amprep.geometry.meshes.topology import edges_match

if TYPE_CHECKING:
    from manifold3d import Manifold


def as_manifold(vertices: ArrayLike, triangles: ArrayLike) -> "Manifold":
    """Hand a mesh to manifold3d; its `status` says whether it is accepted, a refused one is empty.

    Indices have to be in range. Edges are matched here first: manifold3d 3.5 calls a mesh "not manifold"
    where they do not match, but on some such meshes it crashes.
    """
    from manifold3d import Manifold, Mesh64

    corners = np.array(triangles, np.int64, order="C")
    if len(corners) == 0 or not edges_match(corners):
        return Manifold(Mesh64(np.eye(3), np.array([[0, 1, 2]], np.uint64)))
    points = np.array(vertices, np.float64, order="C")  # a copy: manifold3d takes no read-only arrays
    return Manifold(Mesh64(points, corners.astype(np.uint64)))


def accepted(solid: "Manifold") -> bool:
    """Tell whether manifold3d took the mesh."""
    from manifold3d import Error

    return bool(solid.status() == Error.NoError)
