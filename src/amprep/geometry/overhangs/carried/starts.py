"""Find what of overhangs starts in the air, and which of these starts are wide enough to carry what is beside them."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.geometry.overhangs.regions import components_of_faces
from amprep.geometry.overhangs.surface import Surface, cross_products

_WIDE = 0.5
"""Least width of a level start that carries ledges, as a fraction of the longest ledge."""


class Starts(NamedTuple):
    """Where a part starts in the air.

    Attributes
    ----------
    level
        ``(m,)`` bool, overhanging faces that are a level start, or part of one. Supports hold them completely.
    wide
        ``(m,)`` bool, those of starts that are wide enough to carry ledges, as the plate does.
    pointed
        ``(n,)`` bool, points of starts without any level face: lowest edges and points.
    touching
        ``(n,)`` bool, points of all starts.
    """

    level: Bools
    wide: Bools
    pointed: Bools
    touching: Bools


def find_starts(surface: Surface, minimum: Int64s, overhanging: Bools, ledge: float) -> Starts:
    """Find the starts of a surface.

    The width of a start is that of a strip with the same area and perimeter, so that a square of the side `ledge` is
    just wide enough.

    Parameters
    ----------
    surface
        The merged surface.
    minimum
        ``(n,)`` plateau of each point that is a local minimum, else -1.
    overhanging
        ``(m,)`` bool, the overhanging faces.
    ledge
        Longest ledge, mm.
    """
    level = overhanging & (minimum[surface.triangles] >= 0).all(axis=1)
    patch = components_of_faces(surface, level)
    count = int(patch.max(initial=-1)) + 1
    sides = np.linalg.norm(np.diff(surface.points[surface.edges], axis=1)[:, 0], axis=1)
    inside = np.bincount(surface.half_edge, level[surface.half_face], len(surface.edges))
    at_rim = level[surface.half_face] & (inside[surface.half_edge] == 1)
    number = np.cumsum(level) - 1
    perimeter = np.bincount(patch[number[surface.half_face[at_rim]]], sides[surface.half_edge[at_rim]], count)
    double_area = np.linalg.norm(cross_products(surface.points, surface.triangles[level]), axis=1)
    wide = level.copy()
    wide[level] = (np.bincount(patch, double_area, count) >= _WIDE * ledge * perimeter)[patch]
    held = np.zeros(int(minimum.max(initial=-1)) + 1, np.bool_)
    held[minimum[surface.triangles[level]]] = True
    pointed = minimum >= 0
    pointed[pointed] = ~held[minimum[pointed]]
    return Starts(level, wide, pointed, minimum >= 0)
