"""Shadows: projections of bodies to the plate, as polygons with holes."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s

if TYPE_CHECKING:
    from manifold3d import CrossSection

# Strategy. Every triangle is projected and turned counter-clockwise. An edge that two triangles traverse in opposite
# directions is inside the shadow and cancels; what is left are closed walks along the silhouette, few edges of many
# triangles. They wind around a point as often as triangles cover it, so that the shadow is where they wind at least
# once, which a sweep computes (`manifold3d.CrossSection`, filled where the winding number is positive). This is exact
# for solids as well as for surfaces with a boundary. 200,000 triangles take some 0.2 s.

SEGMENTS = 32
"""Sides of the polygons that stand for circles where outlines are offset."""


def shadow_of(points: Floats, triangles: Int64s) -> "CrossSection":
    """Return the projection of triangles ``(m, 3)`` of points ``(n, 3)`` to the plane z = 0."""
    from manifold3d import CrossSection, FillRule

    return CrossSection(silhouette_walks(points[:, :2], triangles), FillRule.Positive)


def silhouette_walks(points: Floats, triangles: Int64s) -> list[Floats]:
    """Return closed walks ``(k, 2)`` that wind around a point as often as projected triangles cover it."""
    corners, index = np.unique(np.round(points, 7), axis=0, return_inverse=True)
    triangles = index.reshape(-1)[triangles]
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    turned = np.where((area < 0.0)[:, None], triangles[:, ::-1], triangles)[area != 0.0]
    start, end = turned.ravel(), np.roll(turned, -1, axis=1).ravel()
    return [corners[walk] for walk in _walks(*_uncancelled(start, end, len(corners)))]


def _uncancelled(start: Int64s, end: Int64s, count: int) -> tuple[Int64s, Int64s]:
    """Return directed edges without those that cancel, each as often as it is left."""
    forward = start < end
    key = np.where(forward, start * count + end, end * count + start)
    unique, row = np.unique(key, return_inverse=True)
    left = np.bincount(row.reshape(-1), np.where(forward, 1.0, -1.0), len(unique)).round().astype(np.int64)
    a, b = unique // count, unique % count
    times = np.abs(left)
    return np.repeat(np.where(left > 0, a, b), times), np.repeat(np.where(left > 0, b, a), times)


def _walks(start: Int64s, end: Int64s) -> list[list[int]]:
    """Return closed walks along directed edges, of which as many enter each point as leave it."""
    leaving: dict[int, list[int]] = {}
    for a, b in zip(start.tolist(), end.tolist(), strict=True):
        leaving.setdefault(a, []).append(b)
    walks = []
    for first, ends in leaving.items():
        while ends:
            walk, at = [first], ends.pop()
            while at != first:
                walk.append(at)
                at = leaving[at].pop()
            walks.append(walk)
    return walks
