"""Planes of a rectilinear grid that follows the faces of a mesh."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.bounding.grid_cuts.records import GridPlanes

SNAP = 1e-5
"""Distance (mm) of a vertex from a plane of the grid up to which it is moved into the plane."""

UNIFORM = 8
"""Number of cells along an axis where no face asks for planes."""

MOST_PLANES = 12
"""Number of planes along an axis that follow faces."""

LEAST_AREA = 2e-3
"""Area of the faces in a plane, as a fraction of the side of the box around the mesh, from which it gets a plane."""

CLOSEST, LARGE_AREA = 4e-3, 0.1
"""Least distance of planes, as a fraction of the length of the mesh along their axis, unless their area is large."""


def grid_planes(vertices: Floats, triangles: Int64s) -> GridPlanes:
    """Return the planes of a grid that contains a mesh.

    There are planes through the largest faces normal to the axes, and others between them so that no cell is long.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    """
    found = []
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    for axis in range(3):
        height = vertices[:, axis][triangles]
        least = height.min(axis=1)
        flat = height.max(axis=1) - least <= SNAP
        side = np.delete(high - low, axis).prod()
        chosen = _face_planes(
            least[flat], _areas(vertices[triangles[flat]], axis), (low[axis], high[axis]), side
        )
        found.append(_filled(chosen, (high - low)[axis] / UNIFORM))
    return GridPlanes(*found)


def _areas(corners: Floats, axis: int) -> Floats:
    u, v = np.delete(corners, axis, axis=2)[:, 1:].swapaxes(0, 1) - np.delete(corners, axis, axis=2)[:, 0]
    return np.asarray(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2.0)


def _face_planes(height: Floats, area: Floats, ends: tuple[float, float], side: float) -> Floats:
    """Return the ends and the heights with the largest total areas."""
    order = np.argsort(height, kind="stable")
    height, area = height[order], area[order]
    first = np.flatnonzero(np.diff(height, prepend=-np.inf) > SNAP)
    total = np.add.reduceat(area, first) if len(first) else np.empty(0)
    kept = list(ends)
    for k in np.argsort(-total, kind="stable")[:MOST_PLANES]:
        closest = CLOSEST * (ends[1] - ends[0]) if total[k] < LARGE_AREA * side else 10.0 * SNAP
        if total[k] >= LEAST_AREA * side and np.abs(np.array(kept) - height[first[k]]).min() > closest:
            kept.append(float(height[first[k]]))
    return np.array(sorted(kept))


def _filled(planes: Floats, step: float) -> Floats:
    """Return planes with others between them, so that none is farther than a step from the next."""
    parts = np.maximum(np.ceil(np.diff(planes) / max(step, 1e-12) - 1e-6), 1).astype(np.int64)
    filled = [
        np.linspace(a, b, n, endpoint=False) for a, b, n in zip(planes[:-1], planes[1:], parts, strict=True)
    ]
    return np.concatenate([*filled, planes[-1:]])


def snapped(vertices: Floats, planes: GridPlanes) -> Floats:
    """Return vertices, of which those near a plane are moved into it."""
    moved = vertices.copy()
    for axis in range(3):
        heights = planes[axis]
        middles = (heights[1:] + heights[:-1]) / 2.0
        nearest = heights[np.searchsorted(middles, vertices[:, axis])]
        close = np.abs(nearest - vertices[:, axis]) <= SNAP
        moved[close, axis] = nearest[close]
    return moved
