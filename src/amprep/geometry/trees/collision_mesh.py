"""Collision meshes: the triangles of a solid with their OBB tree."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Ints, frozen

if TYPE_CHECKING:
    from amprep.kernels.trees.records import ObbTree


@dataclass(frozen=True, eq=False)
class CollisionMesh:
    """The triangles of a closed, outward oriented mesh with their OBB tree; copies of a part share one.

    Attributes
    ----------
    tree
        Read-only arrays for the kernels in `amprep.kernels.trees`.
    """

    tree: "ObbTree"

    @property
    def triangles(self) -> Floats:
        """Corners in the order of the mesh, ``(n, 3, 3)`` mm."""
        corners = np.empty((len(self.tree.corners), 3, 3))
        corners[self.tree.order] = self.tree.corners.reshape(-1, 3, 3)
        return corners


def collision_mesh(vertices: Floats, triangles: Ints) -> CollisionMesh:
    """Build the OBB tree of a mesh (thesis 2.6; Gottschalk, Lin, Manocha 1996, doi 10.1145/237170.237244).

    The axes of a box are the eigenvectors of the area-weighted covariance of its triangles. A node is split at the mean
    of its vertices along the longest axis; if all centroids are on one side, along the second, then the third axis;
    else its triangles are halved. Leaves have one triangle. The time is proportional to n log n for balanced splits.

    Parameters
    ----------
    vertices, triangles
        A closed mesh, outward oriented: ``(v, 3)`` mm and ``(n, 3)``, n at least 1.
    """
    from amprep.kernels.trees.build import MOMENTS, build_tree, write_cones, write_moments
    from amprep.kernels.trees.records import NODE_WIDTH, ObbTree

    shift = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    corners = np.ascontiguousarray((vertices - shift)[triangles].reshape(-1, 9))
    count = len(corners)
    moments, normals = np.empty((count, MOMENTS)), np.empty((count, 3))
    write_moments(corners, moments, normals)
    order, link = np.arange(count), np.empty(2 * count - 1, np.int32)
    nodes = np.empty((2 * count - 1, NODE_WIDTH))
    work, frames = np.empty((count + 1, 4), np.int64), np.empty((2, 3, 3))
    depth = build_tree(corners, moments, normals, shift, order, nodes, link, work, frames)
    cones = np.empty((2 * count - 1, 4))
    write_cones(link, normals[order], cones)
    tree = ObbTree(
        nodes=frozen(nodes, np.float64),
        link=frozen(link, np.int32),
        cones=frozen(cones, np.float64),
        corners=frozen(vertices[triangles[order]], np.float64, 9),
        normals=frozen(normals[order], np.float64),
        order=frozen(order, np.int64),
        samples=frozen(_samples(vertices, triangles), np.float64),
        hull=frozen(_hull(vertices[np.unique(triangles)]), np.float64),
        depth=int(depth),
    )
    return CollisionMesh(tree)


def _samples(vertices: Floats, triangles: Ints) -> Floats:
    """Return a vertex of each component, ``(k, 3)``; vertices at one position belong together."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, welded = np.unique(vertices, axis=0, return_inverse=True)
    corners = welded.reshape(-1)[triangles]
    ends = corners[:, [0, 1]].T.ravel(), corners[:, [1, 2]].T.ravel()
    graph = coo_array((np.ones(2 * len(corners), np.int8), ends), shape=(len(vertices), len(vertices)))
    _, labels = connected_components(graph, directed=False)
    _, first = np.unique(labels[corners[:, 0]], return_index=True)
    return np.asarray(vertices[triangles[first, 0]])


def _hull(points: Floats) -> Floats:
    """Return the vertices of the convex hull; all points where they have no hull of full dimension."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points
