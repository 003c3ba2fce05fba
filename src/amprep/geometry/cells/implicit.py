"""Mesh an implicit function inside the unit cube."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, MeshArrays
from amprep.geometry.cells.ports import conform
from amprep.geometry.meshes.decimation import decimate

if TYPE_CHECKING:
    from manifold3d import Manifold

# Strategy. The level set of manifold3d evaluates one point at a time and moves points to the surface in an order of its
# own. Two passes make the evaluation fast: the first one only records the points, the function is then evaluated at all
# of them at once, and the second pass looks the values up. Because triangles do not repeat exactly from cell to cell,
# the mesh is made for the cube around the origin, cut in halves along each axis, and the halves are exchanged:
# opposite sides of the cell are then the two sides of one cut, and match exactly.

_DECIMATION = 0.1
"""Largest distance, in steps of the grid, by which decimation moves the surface; the grid is no more accurate."""

_ROUNDING = 1e-9
"""Relative tolerance when comparing the function at a point and at its periodic image."""


def implicit_solid(function: Callable[[Floats], Floats], resolution: int) -> MeshArrays:
    """Return the region of the unit cube in which a periodic function is positive, as a closed mesh.

    Parameters
    ----------
    function
        Takes points ``(n, 3)`` and returns values ``(n,)``; its period is the unit cube.
    resolution
        Steps of the grid along each edge of the cube.

    Returns
    -------
    points, triangles
        No triangles if the function is nowhere positive. Opposite sides of the cube have the same triangles.

    Raises
    ------
    ValueError
        If the function does not return one finite number for each point.
    """
    from manifold3d import Manifold

    step = 1.0 / resolution
    solid = _level_set(function, step) ^ Manifold.cube([1.0] * 3, center=True)
    for axis in np.eye(3).tolist():
        above, below = (half.warp_batch(_on_halves) for half in solid.split_by_plane(axis, 0.0))
        solid = above + below.translate(axis)
    mesh = solid.to_mesh64()
    points, triangles = conform(
        np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int64)
    )
    if not len(triangles):
        return points, triangles
    sides = np.column_stack([points == 0.0, points == 1.0]) @ (1 << np.arange(6))
    return decimate(points, triangles, _DECIMATION * step, sides)


def _level_set(function: Callable[[Floats], Floats], step: float) -> "Manifold":
    """Return the region around the unit cube, centred on the origin, in which the function is positive."""
    from manifold3d import Manifold

    bounds = [-0.5 - step] * 3 + [0.5 + step] * 3
    edge_length = step * (1.0 - 1e-9)  # so that rounding does not remove a step
    asked: list[tuple[float, float, float]] = []

    def note(x: float, y: float, z: float) -> float:
        asked.append((x, y, z))
        return -1.0

    Manifold.level_set(note, bounds, edge_length)
    values = _periodic(function, np.array(asked))
    known: dict[tuple[float, float, float], float] = dict(zip(asked, values.tolist(), strict=True))

    def answer(x: float, y: float, z: float) -> float:
        return known[x, y, z]

    return Manifold.level_set(answer, bounds, edge_length)


def _on_halves(points: Floats) -> Floats:
    """Move points that rounding took off the planes of the cuts back onto them."""
    halves = np.round(2.0 * points) / 2.0
    return np.asarray(np.where(np.abs(points - halves) < _ROUNDING, halves, points))


def _periodic(function: Callable[[Floats], Floats], points: Floats) -> Floats:
    """Return values that are equal at a point and at its periodic image, unless they differ by more than rounding."""
    values = _values(function, points)
    wrapped = _values(function, np.round(points, 12) % 1.0)
    same = np.abs(values - wrapped) < _ROUNDING * max(float(np.abs(values).max()), 1e-300)
    return np.asarray(np.where(same, wrapped, values))


def _values(function: Callable[[Floats], Floats], points: Floats) -> Floats:
    values = np.asarray(function(points), np.float64)
    if values.shape != (len(points),) or not np.isfinite(values).all():
        raise ValueError(
            f"the function of a cell must return one finite number for each of {len(points)} points, "
            f"got an array of shape {values.shape}"
        )
    return values
