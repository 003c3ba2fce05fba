"""Unite solids with manifold3d, and convert them to arrays as a build file stores them."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.welding import round_as_stored

if TYPE_CHECKING:
    from manifold3d import Manifold


FILE_STEP = 3e-5
"""Largest distance (mm) by which rounding to float32 moves a vertex within 500 mm of the origin."""

_TOLERANCES = (FILE_STEP, 1e-6, 1e-7)
"""Tolerances (mm) of the simplification of finished solids, from which the first that keeps the volume is taken."""

_SAME_VOLUME = 1e-4
"""Volume (mm3) by which simplification may change a solid."""


def union(solids: Sequence["Manifold"]) -> "Manifold":
    """Unite solids in pairs, and evaluate each union at once.

    manifold3d defers unions by default, and then treats solids whose boxes do not overlap as one solid, even if
    they touch. Later operations on such a solid may lose volume.
    """
    from manifold3d import Manifold

    if not solids:
        return Manifold()
    if len(solids) == 1:
        return solids[0]
    half = len(solids) // 2
    return evaluated(union(solids[:half]) + union(solids[half:]))


def evaluated(solid: "Manifold") -> "Manifold":
    """Carry out pending operations of a solid, and return it."""
    solid.num_tri()
    return solid


def arrays_of(solid: "Manifold") -> tuple[Floats, Int64s]:
    """Return the points ``(n, 3)`` and triangles ``(m, 3)`` of a solid."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int64)


def is_solid(points: Floats, triangles: Int64s) -> bool:
    """Tell whether manifold3d accepts a mesh as a solid with positive volume."""
    from manifold3d import Error

    solid = as_manifold(points, triangles)
    return bool(solid.status() == Error.NoError and solid.volume() > 0.0)


def finish(solids: Sequence["Manifold"]) -> tuple[Floats, Int64s]:
    """Unite solids and return arrays as a build file stores them: closed, and without degenerate triangles."""
    whole = union(solids)
    if whole.is_empty():
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    # moving the vertices takes half as long as reading rounded arrays
    points, triangles = arrays_of(_simplified(whole.warp_batch(round_as_stored)))
    return round_as_stored(points), triangles


def _simplified(solid: "Manifold") -> "Manifold":
    """Remove degenerate triangles and, where that keeps the shape, triangles that rounding makes superfluous.

    At needles manifold3d may remove much more than its tolerance says: walls moved by 0.05 mm, and supports entered
    parts. Then the volume changes, and a smaller tolerance is taken.
    """
    for tolerance in _TOLERANCES:
        found = solid.simplify(tolerance)
        if abs(found.volume() - solid.volume()) <= _SAME_VOLUME:
            break
    return found
