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
    """Return for each component a point on the surface and one in the solid below it, ``(k, 6)``.

    The point on the surface is the centroid of the largest triangle; the other one is half-way from there to the next
    point of the surface inwards.
    """
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    by_area = np.argsort(-areas, kind="stable")
    _, first = np.unique(_components(vertices, triangles)[by_area], return_index=True)
    samples = np.empty((len(first), 6))
    for sample, t in zip(samples, by_area[first], strict=True):
        inwards = -normals[t] / areas[t] if areas[t] > 0 else np.zeros(3)
        sample[:3] = corners[t].mean(axis=0)
        sample[3:] = sample[:3] + 0.5 * _free_length(sample[:3], inwards, corners, t) * inwards
    return samples


def _components(vertices: Floats, triangles: Ints) -> Ints:
    """Return the component of each triangle, ``(n,)``; vertices at one position belong together."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, welded = np.unique(vertices, axis=0, return_inverse=True)
    ends = welded.reshape(-1)[triangles]
    links = ends[:, [0, 1]].T.ravel(), ends[:, [1, 2]].T.ravel()
    graph = coo_array((np.ones(2 * len(ends), np.int8), links), shape=(len(vertices), len(vertices)))
    _, labels = connected_components(graph, directed=False)
    return np.asarray(labels[ends[:, 0]])


def _free_length(origin: Floats, direction: Floats, corners: Floats, own: int) -> float:
    """Return the length of a ray until it meets a triangle other than its own, mm; 0 if it meets none."""
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(direction, v)
    scale = np.einsum("ij,ij->i", across, u)
    out = origin - corners[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        first = np.einsum("ij,ij->i", across, out) / scale
        around = np.cross(out, u)
        second = around @ direction / scale
        length = np.einsum("ij,ij->i", around, v) / scale
        met = (first >= 0) & (second >= 0) & (first + second <= 1) & (length > 0)
    met[own] = False
    return float(length[met].min(initial=np.inf)) if met.any() else 0.0


def _hull(points: Floats) -> Floats:
    """Return the vertices of the convex hull; all points where they have no hull of full dimension."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points
