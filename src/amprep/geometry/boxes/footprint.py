"""Footprints in plan: convex outline, smallest enclosing circle, and angles at which a side is parallel to an axis."""

import numpy as np

from amprep.arrays import Floats

_MANY, _DIRECTIONS = 1000, 32
"""Number of points from which those inside are left out first, and the directions that tell them."""


def convex_outline(points: Floats) -> Floats:
    """Return the corners of the convex hull of points ``(n, 2)``, counter-clockwise (Andrew 1979).

    Andrew's monotone chain, DOI 10.1016/0020-0190(79)90072-3. Points on its sides are no corners. Of many points, those
    within the polygon of the farthest ones in some directions are left out first (Akl and Toussaint 1978, DOI
    10.1016/0020-0190(78)90003-0).
    """
    ordered = np.unique(points if len(points) < _MANY else _outer_points(points), axis=0)
    if len(ordered) < 3:
        return ordered
    rows = [(x, y) for x, y in ordered.tolist()]
    lower, upper = _chain(rows), _chain(rows[::-1])
    return np.array(lower[:-1] + upper[:-1])


def _outer_points(points: Floats) -> Floats:
    """Return the points ``(n, 2)`` without those clearly inside the polygon of the farthest ones in some directions."""
    angles = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)
    corners = points[
        [int((points @ way).argmax()) for way in np.column_stack([np.cos(angles), np.sin(angles)])]
    ]
    sides = np.roll(corners, -1, axis=0) - corners
    outer = np.zeros(len(points), np.bool_)
    tolerance = 1e-9 * float(np.ptp(points, axis=0).max()) ** 2
    for (x, y), (dx, dy) in zip(corners.tolist(), sides.tolist(), strict=True):
        if dx or dy:
            outer |= dx * (points[:, 1] - y) - dy * (points[:, 0] - x) <= tolerance
    return points[outer] if outer.any() else points


def _chain(rows: list[tuple[float, float]]) -> list[tuple[float, float]]:
    chain: list[tuple[float, float]] = []
    for x, y in rows:
        while len(chain) > 1:
            (ax, ay), (bx, by) = chain[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                break
            chain.pop()
        chain.append((x, y))
    return chain


def enclosing_radius(outline: Floats) -> float:
    """Return the radius of the smallest circle around the corners ``(n, 2)`` of a convex outline.

    Strategy (Elzinga and Hearn 1972, DOI 10.1287/trsc.6.4.379): keep the circle of two or three corners, add the
    farthest corner outside, and drop a corner that the smallest circle of the four does not need. The radius grows at
    every step, so that the search ends.
    """
    centre = (outline.min(axis=0) + outline.max(axis=0)) / 2.0
    support = outline[[int(np.argmax(np.linalg.norm(outline - centre, axis=1)))]]
    for _ in range(10 * len(outline) + 10):
        centre, radius, support = _smallest_circle(support)
        distance = np.linalg.norm(outline - centre, axis=1)
        farthest = int(np.argmax(distance))
        if distance[farthest] <= radius * (1.0 + 1e-12) + 1e-12:
            break
        support = np.vstack([support, outline[farthest]])
    return float(np.linalg.norm(outline - centre, axis=1).max())


def flush_angles(outline: Floats) -> Floats:
    """Return the angles (radians) by which each side of an outline ``(n, 2)`` is turned parallel to x."""
    side = np.roll(outline, -1, axis=0) - outline
    side = side[np.argsort(-np.linalg.norm(side, axis=1), kind="stable")]
    angles: Floats = -np.arctan2(side[:, 1], side[:, 0])
    return angles


def _smallest_circle(points: Floats) -> tuple[Floats, float, Floats]:
    """Return centre and radius of the smallest circle around at most four points, and those of them that it needs."""
    best: tuple[Floats, float, Floats] | None = None
    for chosen in _subsets(len(points)):
        corners = points[list(chosen)]
        centre = _centre(corners)
        if centre is None:
            continue
        radius = float(np.linalg.norm(corners - centre, axis=1).max())
        around = np.linalg.norm(points - centre, axis=1).max() <= radius * (1.0 + 1e-12) + 1e-12
        if around and (best is None or radius < best[1]):
            best = centre, radius, corners
    if best is None:  # rounding: a circle that is a little too large
        centre = (points.min(axis=0) + points.max(axis=0)) / 2.0
        return centre, float(np.linalg.norm(points - centre, axis=1).max()), points[:3]
    return best


def _subsets(count: int) -> list[tuple[int, ...]]:
    from itertools import combinations

    return [chosen for size in (1, 2, 3) for chosen in combinations(range(count), size)]


def _centre(corners: Floats) -> Floats | None:
    """Return the centre of the circle through one, two or three points; None if three are on a line."""
    if len(corners) < 3:
        return np.asarray(corners.mean(axis=0))
    a, b = corners[1] - corners[0], corners[2] - corners[0]
    cross = 2.0 * (a[0] * b[1] - a[1] * b[0])
    if abs(cross) < 1e-14 * float(np.linalg.norm(a) * np.linalg.norm(b)):
        return None
    squares = np.array([a @ a, b @ b])
    return np.asarray(
        corners[0]
        + np.array([b[1] * squares[0] - a[1] * squares[1], a[0] * squares[1] - b[0] * squares[0]]) / cross
    )
