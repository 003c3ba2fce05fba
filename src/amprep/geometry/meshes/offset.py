"""Inward offset of a solid: the part that is deeper than a given distance below its surface."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.manifold import as_manifold

MOST_POINTS = 800_000
"""Largest number of grid points; manifold3d evaluates them one at a time."""

_MOST_SAMPLES = 2_000_000
"""Largest number of sample points on the surface."""

_SIMPLIFY = 200.0
"""The result is simplified by at most the depth divided by this."""

_SAMPLES_PER_DEPTH = 6.0
"""Spacing of sample points on the surface: the depth divided by this, unless that gives too many."""


def offset_inwards(points: Floats, triangles: Int64s, depth: float, step: float) -> tuple[Floats, Int64s]:
    """Return a closed mesh of the points of a solid at least `depth` mm below its surface.

    It is a level set of the distance to sample points on the surface, which errs inwards: the skin around it is nowhere
    thinner than `depth`, and its edges and corners are slightly blunt.

    Parameters
    ----------
    points, triangles
        The solid, ``(n, 3)`` mm and ``(m, 3)``.
    depth
        Thickness of the skin, mm.
    step
        Pitch of the grid on which the distance is evaluated, mm; larger for large solids.

    Returns
    -------
    points, triangles
        ``(k, 3)`` mm and ``(l, 3)``; empty if the solid is nowhere that thick.
    """
    from manifold3d import Manifold

    low, high = points.min(axis=0), points.max(axis=0)
    step = max(step, float((2.0 * np.prod(high - low) / MOST_POINTS) ** (1.0 / 3.0)))
    asked: list[tuple[float, float, float]] = []

    def note(x: float, y: float, z: float) -> float:
        asked.append((x, y, z))
        return -1.0

    bounds = [*(low - step).tolist(), *(high + step).tolist()]
    Manifold.level_set(note, bounds, step)
    values = _excess(np.array(asked), points, triangles, depth, step)
    known = dict(zip(asked, values.tolist(), strict=True))
    found = Manifold.level_set(lambda x, y, z: known[x, y, z], bounds, step)
    return arrays_of((found ^ as_manifold(points, triangles)).simplify(depth / _SIMPLIFY))


def _excess(places: Floats, points: Floats, triangles: Int64s, depth: float, most: float) -> Floats:
    """Return the depth of points below the surface minus `depth`, at most `most`; outside the solid, minus `depth`."""
    from scipy.spatial import cKDTree

    result = np.full(len(places), -depth)
    within = np.flatnonzero(inside(places, points, triangles.astype(np.int32)))
    samples, spacing = _samples(points, triangles, depth / _SAMPLES_PER_DEPTH)
    farthest = float(np.hypot(depth + most, spacing))  # a longer search is slow and not needed
    distance, _ = cKDTree(samples).query(places[within], distance_upper_bound=farthest, workers=-1)
    # every point of the surface has a sample within `spacing`, so the surface may be nearer than the sample by that
    surface = np.sqrt(np.maximum(np.minimum(distance, farthest) ** 2 - spacing**2, 0.0))
    result[within] = surface - depth
    return result


def _samples(points: Floats, triangles: Int64s, spacing: float) -> tuple[Floats, float]:
    """Return points on triangles, and a distance within which every point of a triangle has one of them.

    The points are in rows parallel to the longest side of each triangle.
    """
    corners = points[triangles]
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    first = (sides.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = (np.take_along_axis(corners, first[:, [k], None], axis=1)[:, 0] for k in range(3))
    length = sides.max(axis=1)
    height = np.linalg.norm(np.cross(b - a, c - a), axis=1) / np.maximum(length, 1e-12)
    along, rows = (np.ceil(each / spacing) + 1.0 for each in (length, height))
    while (along * rows).sum() > _MOST_SAMPLES and (along * rows).max() > 4:
        spacing *= 1.25
        along, rows = (np.ceil(each / spacing) + 1.0 for each in (length, height))
    count = (along * rows).astype(np.int64)
    owner = np.repeat(np.arange(len(count)), count)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    row, column = np.divmod(place, along[owner].astype(np.int64))
    u = column / np.maximum(along[owner] - 1.0, 1.0)
    v = row / np.maximum(rows[owner] - 1.0, 1.0)
    u, v = u[:, None], v[:, None]
    return (1.0 - v) * (a[owner] + u * (b - a)[owner]) + v * c[owner], 1.2 * spacing
