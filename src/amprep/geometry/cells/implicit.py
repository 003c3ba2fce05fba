"""A function of the point, positive inside, as a closed mesh in the unit cube."""

from collections.abc import Callable

import numpy as np

from amprep.arrays import Floats, MeshArrays
from amprep.geometry.cells.ports import conform
from amprep.geometry.meshes.decimation import decimate

_THINNED = 0.1
"""Of a step of the grid: how far the surface may move so that it has fewer triangles; the grid is no better."""

_ROUNDING = 1e-9
"""Of the greatest value: what rounding may make of the difference between a point and the same one next door."""


def implicit_solid(function: Callable[[Floats], Floats], resolution: int) -> MeshArrays:
    """Return where the function is positive, cut to the unit cube; the function has to repeat with the cube.

    manifold3d's level set asks for one point at a time; so it is asked twice, first to learn its points, which
    the function then gets all at once. It moves points to the surface in an order of its own, so its triangles do
    not quite repeat from cell to cell. Therefore it meshes the cube around the origin; that is cut in halves
    along each axis and these change places: opposite sides of the cell are then both sides of one cut. At last
    triangles between the sides are made fewer.

    Parameters
    ----------
    function
        Takes ``(n, 3)``, gives ``(n,)``.
    resolution
        Steps of the grid along each side.

    Returns
    -------
    points, triangles
        Without triangles when the function is nowhere positive.

    Raises
    ------
    ValueError
        When the function does not give one finite number for each point.
    """
    from manifold3d import Manifold

    step = 1.0 / resolution
    bounds = [-0.5 - step] * 3 + [0.5 + step] * 3
    at_most = step * (1.0 - 1e-9)  # so that rounding makes it no step less
    asked: list[tuple[float, float, float]] = []

    def note(x: float, y: float, z: float) -> float:
        asked.append((x, y, z))
        return -1.0

    Manifold.level_set(note, bounds, at_most)
    points = np.array(asked)
    values = _periodic(function, points)
    known: dict[tuple[float, float, float], float] = dict(zip(asked, values.tolist(), strict=True))

    def answer(x: float, y: float, z: float) -> float:
        return known[x, y, z]

    solid = Manifold.level_set(answer, bounds, at_most) ^ Manifold.cube([1.0] * 3, center=True)
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
    return decimate(points, triangles, _THINNED * step, sides)


def _on_halves(points: Floats) -> Floats:
    """Put what rounding moved off the planes of the cuts back onto them."""
    halves = np.round(2.0 * points) / 2.0
    return np.asarray(np.where(np.abs(points - halves) < _ROUNDING, halves, points))


def _periodic(function: Callable[[Floats], Floats], points: Floats) -> Floats:
    """Return values that are the same to the last bit where rounding alone makes them differ between cells."""
    values = _values(function, points)
    wrapped = _values(function, np.round(points, 12) % 1.0)
    same = np.abs(values - wrapped) < _ROUNDING * max(float(np.abs(values).max()), 1e-300)
    return np.asarray(np.where(same, wrapped, values))


def _values(function: Callable[[Floats], Floats], points: Floats) -> Floats:
    values = np.asarray(function(points), np.float64)
    if values.shape != (len(points),) or not np.isfinite(values).all():
        raise ValueError(
            f"the cell's function gives one finite number for each of {len(points)} points, got {values.shape}"
        )
    return values
