"""Sum up what the overhangs of a part cost in many directions."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.kernels.helper import kernel

HEIGHT, AREA, PLAN, VOLUME, EDGES, UNDER_EDGES = range(6)
"""Columns of the scores: height of the part (mm), area of the faces that need support, also in plan (mm2), and the
volume under them (mm3), length of the knife edges (mm) and the area under them (mm2)."""


class ScoredFaces(NamedTuple):
    """The faces of a part.

    Attributes
    ----------
    points, triangles
        ``(n, 3)`` mm, ``(m, 3)``.
    normals, areas
        ``(m, 3)`` unit vectors out of the solid, ``(m,)`` mm2.
    open_share
        ``(m,)`` fraction of each triangle that the part does not carry where the triangle is an overhang.
    steep
        ``(m,)`` cosine of the angle to the plate from which each triangle is no overhang.
    """

    points: Floats
    triangles: Ints
    normals: Floats
    areas: Floats
    open_share: Floats
    steep: Floats


class ScoredEdges(NamedTuple):
    """The edges of a part that may be knife edges.

    Attributes
    ----------
    ends
        ``(e, 2)`` points.
    rays
        ``(e, 2, 3)`` unit vectors in the two faces of each, away from the edge.
    beside
        ``(e, 2)`` these faces.
    """

    ends: Ints
    rays: Floats
    beside: Ints


@kernel
def score_directions(
    faces: ScoredFaces,
    knives: ScoredEdges,
    directions: Floats,
    limits: Floats,
    heights: Floats,
    scores: Floats,
) -> None:
    """Sum up the overhangs in each direction.

    Parameters
    ----------
    faces, knives
        The part.
    directions
        ``(k, 3)`` unit vectors that point up.
    limits
        ``(4,)`` lift of the part above the plate and height up to which geometry is on the plate, mm; the sine of the
        overhang angle; its cosine.
    heights
        ``(n,)`` scratch.
    scores
        ``(k, 6)`` out, by the columns named above.
    """
    points, triangles, normals, areas = faces.points, faces.triangles, faces.normals, faces.areas
    edges, rays, beside = knives.ends, knives.rays, knives.beside
    lift, plate, flat, cosine = limits[0], limits[1], limits[2], limits[3]
    for k in range(len(directions)):
        x, y, z = directions[k, 0], directions[k, 1], directions[k, 2]
        low, high = np.inf, -np.inf
        for n in range(len(points)):
            height = points[n, 0] * x + points[n, 1] * y + points[n, 2] * z
            heights[n] = height
            low, high = min(low, height), max(high, height)
        floor = low - lift
        area, plan, volume = 0.0, 0.0, 0.0
        for m in range(len(triangles)):
            facing = -(normals[m, 0] * x + normals[m, 1] * y + normals[m, 2] * z)
            if facing <= faces.steep[m]:
                continue
            a, b, c = heights[triangles[m, 0]], heights[triangles[m, 1]], heights[triangles[m, 2]]
            if max(a, b, c) - floor <= plate:
                continue
            share = faces.open_share[m] * areas[m]
            area += share
            plan += share * facing
            volume += share * facing * ((a + b + c) / 3.0 - floor)
        length, under = 0.0, 0.0
        for e in range(len(edges)):
            a, b = heights[edges[e, 0]], heights[edges[e, 1]]
            if max(a, b) - floor <= plate:
                continue
            if rays[e, 0, 0] * x + rays[e, 0, 1] * y + rays[e, 0, 2] * z <= 1e-6:
                continue
            if rays[e, 1, 0] * x + rays[e, 1, 1] * y + rays[e, 1, 2] * z <= 1e-6:
                continue
            one, two = beside[e, 0], beside[e, 1]
            if -(normals[one, 0] * x + normals[one, 1] * y + normals[one, 2] * z) > cosine:
                continue
            if -(normals[two, 0] * x + normals[two, 1] * y + normals[two, 2] * z) > cosine:
                continue
            dx = points[edges[e, 0], 0] - points[edges[e, 1], 0]
            dy = points[edges[e, 0], 1] - points[edges[e, 1], 1]
            dz = points[edges[e, 0], 2] - points[edges[e, 1], 2]
            size = np.sqrt(dx * dx + dy * dy + dz * dz)
            if abs(a - b) >= flat * size:
                continue
            length += size
            under += np.sqrt(max(size * size - (a - b) * (a - b), 0.0)) * ((a + b) / 2.0 - floor)
        scores[k, HEIGHT] = high - low
        scores[k, AREA], scores[k, PLAN], scores[k, VOLUME] = area, plan, volume
        scores[k, EDGES], scores[k, UNDER_EDGES] = length, under
