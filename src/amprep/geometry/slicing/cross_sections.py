"""Areas of the horizontal cross-sections of a solid."""

import numpy as np

from amprep.arrays import Bools, Floats

ROWS = 1_000_000
"""Pairs of a triangle and a plane that are computed at once, because each needs about 200 bytes."""


def cross_section_areas(corners: Floats, heights: Floats) -> Floats:
    """Return the areas of the cross-sections of a solid, ``(k,)`` mm2; overlaps of its shells count repeatedly.

    A plane cuts each triangle in a segment. The sum of the cross products of the ends of all segments is twice the area
    (Green's theorem), so that the contours need not be linked.

    Parameters
    ----------
    corners
        ``(n, 3, 3)`` mm, triangles of a closed mesh, outward oriented.
    heights
        ``(k,)`` mm, ascending.
    """
    areas = np.zeros(len(heights))
    first = np.searchsorted(heights, corners[:, :, 2].min(axis=1), side="right")
    counts = np.searchsorted(heights, corners[:, :, 2].max(axis=1), side="right") - first
    ends = np.cumsum(counts)
    at = 0
    while at < len(corners):
        done = int(ends[at] - counts[at])
        stop = max(int(np.searchsorted(ends, done + ROWS, side="right")), at + 1)
        own = np.repeat(np.arange(at, stop), counts[at:stop])
        plane = first[own] + np.arange(done, ends[stop - 1]) - (ends - counts)[own]
        areas += np.bincount(plane, _twice_areas(corners[own], heights[plane]), len(heights)) / 2.0
        at = stop
    return areas


def _twice_areas(corners: Floats, heights: Floats) -> Floats:
    """Return the cross product of the ends of the segment in which each plane cuts its triangle, ``(r,)`` mm2."""
    above = corners[:, :, 2] >= heights[:, None]
    following, rows = np.roll(above, -1, axis=1), np.arange(len(corners))

    def crossing(edges: Bools) -> Floats:
        edge = edges.argmax(axis=1)
        start, end = corners[rows, edge], corners[rows, (edge + 1) % 3]
        fraction = (heights - start[:, 2]) / (end[:, 2] - start[:, 2])
        return np.asarray(start[:, :2] + fraction[:, None] * (end - start)[:, :2])

    down, up = crossing(above & ~following), crossing(~above & following)
    return np.asarray(down[:, 0] * up[:, 1] - down[:, 1] * up[:, 0])
