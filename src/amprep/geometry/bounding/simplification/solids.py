"""Solids before and after a simplification: shells that overlap, the convex hull, and a remainder outside."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import MeshArrays
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


def hull(mesh: MeshArrays) -> MeshArrays:
    """Return the convex hull of a mesh."""
    from manifold3d import Manifold

    return arrays_of(Manifold.hull_points(np.array(mesh[0], np.float64, order="C")))


def united(one: MeshArrays, other: MeshArrays) -> MeshArrays:
    """Return the union of two solids."""
    return arrays_of(as_manifold(*one) + as_manifold(*other))


def arrays_of(solid: "Manifold") -> MeshArrays:
    """Return the vertices and triangles of a solid of manifold3d."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int64)
