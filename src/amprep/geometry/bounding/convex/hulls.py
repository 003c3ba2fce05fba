"""Closed meshes of convex hulls that contain their points with certainty."""

import numpy as np

from amprep.arrays import Floats, MeshArrays
from amprep.geometry.meshes.topology import edges_match

OUTWARD = 1e-6
"""Least distance (mm) by which a hull is moved outward, so that rounding leaves nothing outside."""

OUTWARD_FRACTION = 3e-7
"""The same as a fraction of the largest coordinate; manifold3d computes hulls to a third of it."""

CUBE = 3.0
"""Half side of the cubes around the points of a flat hull, as a multiple of the distance outward."""


def containing_hull(points: Floats) -> MeshArrays:
    """Return a closed convex mesh that contains the convex hull of points ``(n, 3)`` mm, moved outward a little.

    The hull is scaled about its centre. A hull that is so flat that this would move its corners too far is replaced by
    that of small cubes around the points.
    """
    outward = OUTWARD + OUTWARD_FRACTION * float(np.abs(points).max())
    scaled = _scaled_hull(points, outward)
    if scaled is not None:
        return scaled
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * CUBE * outward
    return _hull_mesh((points[:, None] + cube).reshape(-1, 3))


def _scaled_hull(points: Floats, outward: float) -> MeshArrays | None:
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        return None
    corners = points[hull.vertices]
    middle = corners.mean(axis=0)
    inner = float((-hull.equations[:, :3] @ middle - hull.equations[:, 3]).min())
    reach = float(np.linalg.norm(corners - middle, axis=1).max())
    if inner < 1e-3 * reach:
        return None
    return _hull_mesh(middle + (corners - middle) * (1.0 + outward / inner))


def _hull_mesh(points: Floats) -> MeshArrays:
    """Return the convex hull as a closed mesh with outward normals.

    Qhull computes it exactly, but where it merges nearly coplanar facets its triangles may not match. Then manifold3d
    computes it, accurate to 1e-7 of the size.
    """
    from manifold3d import Manifold
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    corners = np.sort(hull.vertices)
    vertices, triangles = points[corners], np.searchsorted(corners, hull.simplices).astype(np.int64)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    triangles[inward] = triangles[inward][:, ::-1]
    if edges_match(triangles):
        return vertices, triangles
    middle = points.mean(axis=0)
    mesh = Manifold.hull_points(points - middle).to_mesh64()
    return mesh.vert_properties[:, :3] + middle, mesh.tri_verts.astype(np.int64)
