"""Find the level starts of a part that supports hold completely, and that carry what is beside them."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.overhangs.borders import RegionEdges, regions_of
from amprep.checks.overhangs.starts import plateaus
from amprep.checks.overhangs.surface import MergedMesh

_WIDE = 0.5
"""Least width of a level start that carries ledges, as a fraction of the longest ledge."""

_GRANT = 0.1
"""Fraction of that width that is granted."""


class JudgedStarts(NamedTuple):
    """Where a part starts in the air.

    Attributes
    ----------
    points
        ``(n,)`` bool, points of starts.
    level, wide
        ``(m,)`` bool, triangles of level starts, and of those that carry what is beside them.
    pointed
        ``(n,)`` bool, points of starts without level triangles.
    climb
        Greatest height (mm) of an anchor above a point that it carries, in a region with a start.
    """

    points: Bools
    level: Bools
    wide: Bools
    pointed: Bools
    climb: float


def judged_starts(
    surface: MergedMesh, faces: Int64s, starts: Bools, ledge: float, climb: float, sign: float
) -> JudgedStarts:
    """Return the starts of a part.

    Parameters
    ----------
    surface
        The part.
    faces
        ``(f,)`` overhanging triangles.
    starts
        ``(n,)`` bool, points at which the part starts in the air.
    ledge
        Longest ledge, mm.
    climb
        See `JudgedStarts`.
    sign
        1 if less width counts as wide, -1 if only more does.
    """
    level, wide = np.zeros(len(surface.triangles), np.bool_), np.zeros(len(surface.triangles), np.bool_)
    flat = faces[starts[surface.triangles[faces]].all(axis=1)]
    level[flat] = True
    if len(flat):
        patch = regions_of(surface, flat)
        wide[flat] = (widths(surface, flat, patch) >= _WIDE * ledge * (1.0 - sign * _GRANT))[patch]
    plateau = plateaus(surface)
    pointed = starts & ~np.isin(plateau, plateau[surface.triangles[flat]])
    return JudgedStarts(starts, level, wide, pointed, climb)


def with_bases(edges: RegionEdges, surface: MergedMesh, faces: Int64s, wide: Bools) -> RegionEdges:
    """Add the rims of wide starts inside regions as anchors of what is beside them.

    Parameters
    ----------
    edges
        Edges of regions.
    surface, faces
        The part, and the triangles ``(f,)`` of its regions.
    wide
        ``(m,)`` bool, triangles of wide starts.
    """
    number = surface.edge[faces].reshape(-1)
    owner = np.repeat(faces, 3)
    both = np.bincount(number, minlength=len(surface.ends)) == 2
    at_wide = np.bincount(number, wide[owner], minlength=len(surface.ends)) == 1
    rims, first = np.unique(number[(both & at_wide)[number]], return_index=True)
    if not len(rims):
        return edges
    region = regions_of(surface, faces)[np.flatnonzero((both & at_wide)[number])[first] // 3]
    start, end = (surface.points[surface.ends[rims, side]] for side in (0, 1))
    yes = np.ones(len(rims), np.bool_)
    more = RegionEdges(start, end, region, yes, yes)
    return RegionEdges(*(np.concatenate(each) for each in zip(edges, more, strict=True)))


def widths(surface: MergedMesh, faces: Int64s, region: Int64s) -> Floats:
    """Return the width (mm) of each region: that of a strip with the same area and perimeter."""
    edge, first, count = np.unique(surface.edge[faces], return_index=True, return_counts=True)
    length = np.linalg.norm(np.diff(surface.points[surface.ends[edge]], axis=1)[:, 0], axis=1)
    perimeter = np.bincount(region[first // 3], weights=np.where(count == 1, length, 0.0))
    return np.asarray(2.0 * np.bincount(region, weights=surface.area[faces]) / np.maximum(perimeter, 1e-12))
