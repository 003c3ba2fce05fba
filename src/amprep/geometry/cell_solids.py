"""Support solids between arrays and manifold3d: unite, round to what a build file keeps, tidy."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.solids import as_manifold
from amprep.geometry.welding import kept

if TYPE_CHECKING:
    from manifold3d import Manifold

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FILE_STEP = 3e-5
"""mm; what rounding to float32 moves a vertex at most, up to 500 mm from the origin."""

_SAME_VOLUME = 1e-9
"""Share; folds that matter change far more, rounding far less."""


def union(solids: Sequence["Manifold"]) -> "Manifold":
    """Unite solids."""
    from manifold3d import Manifold, OpType

    return Manifold.batch_boolean(list(solids), OpType.Add)


def arrays_of(solid: "Manifold") -> tuple[Floats, Ints]:
    """Return points ``(n, 3)`` and triangles ``(m, 3)`` of a solid."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int64)


def stable_union(solids: Sequence["Manifold"], tolerance: float) -> tuple[Floats, Ints]:
    """Unite a few solids to arrays that manifold3d reads back as the same solid.

    Where solids touch in parts of a plane, manifold3d may leave a triangle folded back onto its neighbour; when
    such a mesh is read again, its volume changes. Another order of uniting then helps.

    Parameters
    ----------
    tolerance
        Details below it are smoothed away.
    """
    first = None
    for order in _orders(len(solids)):
        whole = solids[order[0]]
        for index in order[1:]:
            whole = whole + solids[index]
        arrays = arrays_of(whole.simplify(tolerance))
        first = first or arrays
        if abs(as_manifold(*arrays).volume() - whole.volume()) <= _SAME_VOLUME * whole.volume():
            return arrays
    if first is None:
        raise ValueError("a union needs at least one solid")
    return first


def _orders(count: int) -> list[list[int]]:
    """Return some orders of `count` things: turned, and turned backwards."""
    turned = [[(start + i) % count for i in range(count)] for start in range(min(count, 4))]
    return turned + [order[::-1] for order in turned]


def is_solid(points: Floats, triangles: Ints) -> bool:
    """Whether manifold3d accepts a mesh as a solid with positive volume."""
    from manifold3d import Error

    solid = as_manifold(points, triangles)
    return bool(solid.status() == Error.NoError and solid.volume() > 0.0)


def finish(solids: Sequence["Manifold"]) -> tuple[Floats, Ints]:
    """Unite solids to the arrays that a build file keeps: closed, no triangle without area."""
    whole = union(solids)
    points, triangles = arrays_of(whole)
    again = as_manifold(kept(points), triangles).simplify(FILE_STEP)
    points, triangles = arrays_of(again)
    return kept(points), triangles
