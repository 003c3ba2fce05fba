"""Solids before and after a simplification: shells that overlap, the convex hull, and a remainder outside."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, MeshArrays
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.shells import measure_shells, solid_volume

if TYPE_CHECKING:
    from manifold3d import Manifold


def without_overlaps(mesh: MeshArrays) -> MeshArrays:
    """Return the union of the shells of a mesh if some overlap and none is a cavity, else the mesh.

    Where shells overlap, a surface lies inside the solid: it costs triangles and is of no use.
    """
    shells = measure_shells(*mesh)
    alone = not shells.may_overlap.any() or (shells.volume < 0.0).any()
    if alone or np.isclose(solid_volume(*mesh, shells), shells.volume.sum(), rtol=1e-12):
        return mesh
    from manifold3d import Manifold, OpType

    return arrays_of(Manifold.batch_boolean(as_manifold(*mesh).decompose(), OpType.Add))


def hull_volume(mesh: MeshArrays) -> float:
    """Return the volume of the convex hull of a mesh, mm3, up to rounding errors."""
    from manifold3d import Manifold

    return float(Manifold.hull_points(np.array(mesh[0], np.float64, order="C")).volume())


def hull(mesh: MeshArrays) -> MeshArrays:
    """Return a convex solid that contains the mesh: its convex hull, moved outward by the rounding errors of hulls."""
    from manifold3d import Manifold

    points = np.array(mesh[0], np.float64, order="C")
    convex = arrays_of(Manifold.hull_points(points))
    reach = 1e-9 * float(np.ptp(points, axis=0).max())
    steps = np.concatenate([np.eye(3), -np.eye(3)])
    for _ in range(20):
        outside = _outside(points, convex)
        if outside <= 0.0:
            break
        reach = max(2.0 * reach, 4.0 * outside)
        convex = arrays_of(Manifold.hull_points((points[:, None] + reach * steps).reshape(-1, 3)))
    return convex


def _outside(points: Floats, convex: MeshArrays) -> float:
    """Return the greatest distance of points beyond the planes of a convex mesh."""
    corners = convex[0][convex[1]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    normal, offset = normal[length > 0.0] / length[length > 0.0, None], corners[length > 0.0, 0]
    level = np.einsum("ij,ij->i", normal, offset)
    own = 1e-15 * float(np.abs(points).max())
    return max(float((points @ normal[i] - level[i]).max()) for i in range(len(level))) - own


def united(one: MeshArrays, other: MeshArrays) -> MeshArrays:
    """Return the union of two solids."""
    return arrays_of(as_manifold(*one) + as_manifold(*other))


def arrays_of(solid: "Manifold") -> MeshArrays:
    """Return the vertices and triangles of a solid of manifold3d."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int64)
