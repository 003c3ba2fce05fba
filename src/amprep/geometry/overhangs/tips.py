"""Find tips: local minima of the surface with the solid above them."""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.regions import connected_components
from amprep.geometry.overhangs.surface import LEVEL, Surface


def minimum_plateaus(surface: Surface, plate: float) -> Int64s:
    """Label each point with its level plateau if that is a local minimum of the solid above `plate`, else with -1."""
    count = len(surface.points)
    start, end = surface.edges[:, 0], surface.edges[:, 1]
    difference = surface.points[end, 2] - surface.points[start, 2]
    level = np.abs(difference) <= LEVEL
    plateau = connected_components(start[level], end[level], count)
    lowest = np.zeros(int(plateau.max(initial=-1)) + 1, np.bool_)
    lowest[plateau[surface.edges.ravel()]] = True
    lowest[plateau[np.where(difference > 0, end, start)[~level]]] = False
    lowest[plateau[surface.points[:, 2] <= plate]] = False
    lowest &= _section_areas(surface, plateau, lowest) < 0
    return np.where(lowest[plateau], plateau, -1)


def _section_areas(surface: Surface, plateau: Int64s, lowest: Bools) -> Floats:
    """Return the signed area (mm2) of the surface's level section just above each local minimum.

    The area is negative (clockwise seen from above) if the solid is above the plateau, and positive at the bottom
    of a pit. A triangle touches at most one minimum, because the higher of two would not be a minimum.
    """
    corners = surface.triangles
    inside = lowest[plateau[corners]]
    group = np.where(inside, plateau[corners], -1).max(axis=1, initial=-1)
    touching = np.flatnonzero((group >= 0) & ~inside.all(axis=1))
    corners, inside, group = corners[touching], inside[touching], group[touching]
    height = surface.points[corners, 2]
    floor = np.full(len(lowest), np.inf)
    np.minimum.at(floor, group, np.where(inside, height, np.inf).min(axis=1, initial=np.inf))
    ceiling = np.full(len(lowest), np.inf)
    np.minimum.at(ceiling, group, np.where(inside, np.inf, height).min(axis=1, initial=np.inf))
    level = 0.5 * (floor + ceiling)[group]
    origin = np.zeros((len(lowest), 2))
    origin[group] = surface.points[corners[np.arange(len(group)), inside.argmax(axis=1)], :2]
    down, up = np.zeros((len(group), 2)), np.zeros((len(group), 2))
    for i in range(3):
        j = (i + 1) % 3
        a, b = surface.points[corners[:, i]], surface.points[corners[:, j]]
        crosses = inside[:, i] != inside[:, j]
        fraction = np.divide(level - a[:, 2], b[:, 2] - a[:, 2], out=np.zeros(len(a)), where=crosses)
        point = a[:, :2] + np.clip(fraction, 0, 1)[:, None] * (b - a)[:, :2] - origin[group]
        leaves = crosses & inside[:, i]
        up[leaves], down[crosses & ~leaves] = point[leaves], point[crosses & ~leaves]
    signed = up[:, 0] * down[:, 1] - up[:, 1] * down[:, 0]
    return np.asarray(np.bincount(group, weights=signed, minlength=len(lowest)), np.float64)


def tips_of(minimum: Int64s, corners: Int64s, ends: Int64s) -> tuple[Int64s, Int64s]:
    """Return the points of local minima that no overhanging face and no knife edge touches, and their plateaus.

    Parameters
    ----------
    minimum
        ``(n,)`` labels from `minimum_plateaus`.
    corners
        ``(f, 3)`` points of the overhanging faces.
    ends
        ``(e, 2)`` points of the knife edges.
    """
    held = np.zeros(int(minimum.max(initial=-1)) + 2, np.bool_)
    held[minimum[corners.ravel()]] = True
    held[minimum[ends.ravel()]] = True
    held[-1] = True  # the points that are no minimum
    tips = np.flatnonzero(~held[minimum])
    return tips, minimum[tips]


def without_dips(surface: Surface, minimum: Int64s, depth: float) -> Int64s:
    """Return the labels of local minima that are at least `depth` mm deep, else -1.

    The depth of a minimum is the height above it of the lowest saddle from which lower ground is reached.
    """
    from amprep.kernels.overhangs.dips import find_dips

    own = np.flatnonzero(minimum >= 0)
    if not len(own):
        return minimum
    label, first = np.unique(minimum[own], return_index=True)
    ends = np.concatenate([surface.edges, surface.edges[:, ::-1]])
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    starts = np.searchsorted(ends[:, 0], np.arange(len(surface.points) + 1))
    heights = np.ascontiguousarray(surface.points[:, 2])
    dips = label[find_dips(heights, starts, np.ascontiguousarray(ends[:, 1]), own[first], depth, LEVEL)]
    return np.where(np.isin(minimum, dips), -1, minimum)
