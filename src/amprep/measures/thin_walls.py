"""Measure how much of the surface of a solid has a thin wall below it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.meshes.containment import inside
from amprep.model.mesh import Mesh

WALLS_MM = (0.4, 0.8, 1.2)
"""Thicknesses that are measured: about one, two and three lines of a filament printer, or laser tracks and more."""

_SAMPLES = 4000
_SHORTER = 1.0 - 1e-3
"""A wall of just the thickness that is measured is not thinner."""


@dataclass(frozen=True)
class ThinWall:
    """Area (mm2) of the surface where the wall, measured normal to the surface, is thinner than `below_mm`."""

    below_mm: float
    area_mm2: float


def measure_thin_walls(mesh: Mesh, thicknesses: Sequence[float] = WALLS_MM) -> tuple[ThinWall, ...]:
    """Return the area of walls thinner than each thickness.

    Points at regular distances of area are moved into the solid by each thickness; one that comes out on the other
    side, then or before, is above a thin wall. Sharp edges count as thin, since they are. The standard error of a
    fraction p of the surface is at most ``sqrt(p / 4000)``.

    Parameters
    ----------
    mesh
        A closed mesh.
    thicknesses
        mm, ascending.
    """
    points, normals, total = _samples(mesh)
    outside = np.zeros(len(points), np.bool_)
    found = []
    for thickness in thicknesses:
        moved = points - _SHORTER * thickness * normals
        outside |= ~inside(moved, mesh.vertices, mesh.triangles)
        found.append(ThinWall(thickness, float(total * outside.mean())))
    return tuple(found)


def _samples(mesh: Mesh) -> tuple[Floats, Floats, float]:
    """Return points ``(n, 3)`` spread evenly over the surface, the normals there, and the area of the surface."""
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double = np.linalg.norm(normal, axis=1)
    reached = np.cumsum(double)
    number = np.arange(_SAMPLES)
    triangle = np.searchsorted(reached, (number + 0.5) / _SAMPLES * reached[-1])
    triangle = np.minimum(triangle, len(corners) - 1)
    u, v = (
        (number * 0.7548776662466927) % 1.0,
        (number * 0.5698402909980532) % 1.0,
    )  # evenly spread in a square
    u, v = np.where(u + v > 1.0, 1.0 - u, u)[:, None], np.where(u + v > 1.0, 1.0 - v, v)[:, None]
    a, b, c = (corners[triangle, k] for k in range(3))
    unit = normal[triangle] / double[triangle, None]
    return a + u * (b - a) + v * (c - a), unit, float(reached[-1] / 2.0)
