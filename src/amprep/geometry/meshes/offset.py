"""The inside of a solid that lies deeper than a given distance below its surface."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.manifold import as_manifold

MOST_POINTS = 800_000
"""Of the grid; manifold3d asks for one at a time."""

_MOST_SAMPLES = 2_000_000

_SMOOTH = 200.0
"""Part of the depth by which the surface may move when flat triangles are joined."""

_CLOSE = 6.0
"""Samples of the surface lie that many times closer than the depth, if there are not too many of them."""


def offset_inwards(points: Floats, triangles: Int64s, depth: float, step: float) -> tuple[Floats, Int64s]:
    """Return a closed mesh of what lies at least `depth` mm below the surface of a solid.

    A level set of the distance to points sampled on the surface, on a grid of about `step` mm. It errs to the
    inside: what is left around it is nowhere thinner than `depth`, edges and corners inside come out a little blunt.

    Returns
    -------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``; none where the solid is nowhere that thick.
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
    return arrays_of((found ^ as_manifold(points, triangles)).simplify(depth / _SMOOTH))


def _excess(places: Floats, points: Floats, triangles: Int64s, depth: float, most: float) -> Floats:
    """Return how much deeper than `depth` places lie, at most `most`; outside the solid, minus the depth."""
    from scipy.spatial import cKDTree

    result = np.full(len(places), -depth)
    within = np.flatnonzero(inside(places, points, triangles.astype(np.int32)))
    samples, spacing = _samples(points, triangles, depth / _CLOSE)
    farthest = float(np.hypot(depth + most, spacing))  # looking farther takes long, and nobody asks
    distance, _ = cKDTree(samples).query(places[within], distance_upper_bound=farthest, workers=-1)
    # the sample nearest to a surface point is within `spacing` of it: so much farther than the surface may it be
    surface = np.sqrt(np.maximum(np.minimum(distance, farthest) ** 2 - spacing**2, 0.0))
    result[within] = surface - depth
    return result


def _samples(points: Floats, triangles: Int64s, spacing: float) -> tuple[Floats, float]:
    """Return points on triangles, and within which distance of one every point of a triangle lies.

    They stand in rows along the longest side of each triangle.
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
