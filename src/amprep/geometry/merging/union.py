"""Support solids between arrays and manifold3d: unite, round to what a build file keeps, tidy."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.welding import round_as_stored

if TYPE_CHECKING:
    from manifold3d import Manifold


FILE_STEP = 3e-5
"""mm; what rounding to float32 moves a vertex at most, up to 500 mm from the origin."""


def union(solids: Sequence["Manifold"]) -> "Manifold":
    """Unite solids two by two, each pair at once.

    Left to itself, manifold3d puts off several unions and then takes those whose boxes do not overlap as
    one solid, even when they touch: what comes after may lose volume.
    """
    from manifold3d import Manifold

    if not solids:
        return Manifold()
    if len(solids) == 1:
        return solids[0]
    half = len(solids) // 2
    return evaluated(union(solids[:half]) + union(solids[half:]))


def evaluated(solid: "Manifold") -> "Manifold":
    """Return the solid, its pending operations carried out."""
    solid.num_tri()
    return solid


def arrays_of(solid: "Manifold") -> tuple[Floats, Int64s]:
    """Return points ``(n, 3)`` and triangles ``(m, 3)`` of a solid."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int64)


def is_solid(points: Floats, triangles: Int64s) -> bool:
    """Whether manifold3d accepts a mesh as a solid with positive volume."""
    from manifold3d import Error

    solid = as_manifold(points, triangles)
    return bool(solid.status() == Error.NoError and solid.volume() > 0.0)


def finish(solids: Sequence["Manifold"]) -> tuple[Floats, Int64s]:
    """Unite solids to the arrays that a build file keeps: closed, no triangle without area."""
    whole = union(solids)
    points, triangles = arrays_of(whole)
    again = as_manifold(round_as_stored(points), triangles).simplify(FILE_STEP)
    points, triangles = arrays_of(again)
    return round_as_stored(points), triangles
