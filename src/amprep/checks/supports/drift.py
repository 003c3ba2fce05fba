"""Judge drift: no support is farther to the side of the overhangs above it than the rules allow."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.checks.overhangs.modifiers import border_of
from amprep.checks.overhangs.needs import are_needed
from amprep.checks.overhangs.samples import GRANT_DEG, judged_overhangs
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.sampling import sample_segments
from amprep.model.build import Build, PlacedPart, SupportBody
from amprep.model.control import Stop

PROMISE = "drift"

TOLERANCE = 0.1
"""Distance (mm) that is granted to supports."""

_SPACING = 1.0
"""Distance (mm) of samples on overhangs and supports."""

_FINE, _MOST_SAMPLES = 0.1, 1_000_000
"""Distance (mm) of samples where those farther apart may miss what needs support, and their approximate number at most.

Beside a limit of the rules, a strip of a bridge or a bore may be narrow; one that certainly needs support is wider than
the tolerances of both of its sides."""

_BORDER = 1.5
"""Largest distance of the samples that are left out beside a blocker, over the uncertainty of its border."""

_CELL = 0.5
"""Side (mm) of the squares in plan of which only the highest sample counts."""

_FEW = 4
"""Number of the nearest targets of a point that are tried before all of them."""

_CHUNK = 2_000_000
"""Pairs of samples that are computed at once."""


def check_drift(build: Build, stop: Stop) -> list[Violation]:
    """Return the supports with a point that is too far to the side of all overhangs above it that need support.

    A point may be away by the smaller of `drift_mm` and `drift_ratio` times the height up to the overhang, and by one
    square of the support grid more, because drift is planned in squares; at the foot the margin of the base comes on
    top. Supports that parts share may be below the overhangs of any of them. Supports below
    surfaces that enclose no solid are not judged, because their needs are not certain: faces without area have edges.

    Strategy. Few samples of the overhangs decide nearly always. Where a support seems too far away, samples that are
    closer together look for narrow strips that need support.
    """
    rules = build.settings.rules
    found: list[Violation] = []
    if rules.territory != "own" or (rules.drift_mm <= 0.0 and rules.drift_ratio <= 0.0):
        return found
    targets: dict[int, Floats] = {}
    for body in build.supports:
        if stop():
            return found
        if not all(build.parts[part].part.is_solid for part in body.parts):
            continue
        for part in body.parts:
            if part not in targets:
                targets[part] = _targets(build.parts[part], build)
        above = np.concatenate([np.empty((0, 3)), *(targets[part] for part in body.parts)])
        uncertain = _BORDER * max((border_of(build.parts[part]) for part in body.parts), default=0.0)
        found += _judged(body, above, build, uncertain)
    return found


def _targets(placed: PlacedPart, build: Build) -> Floats:
    """Return points on the overhangs of a part that may need support, ``(n, 3)`` mm."""
    found = judged_overhangs(placed, build.settings.rules, _SPACING)
    rows = np.arange(len(found.samples.points))
    needed = are_needed(found, build.settings.rules, rows, strict=True)
    points = found.samples.points[rows[needed]]
    return points[_highest(points)]


def _close_targets(placed: PlacedPart, build: Build, below: Floats, beside: float, lowest: float) -> Floats:
    """Return closer points on overhangs that may need support, at most `beside` mm to the side of some points.

    `lowest` (mm) is the least height of overhangs that count.
    """
    from scipy.spatial import KDTree

    rules, mesh = build.settings.rules, placed.mesh
    extent = np.ptp(mesh.vertices[:, :2], axis=0)
    spacing, tree = max(_FINE, float(np.sqrt(extent.prod() / _MOST_SAMPLES))), KDTree(below[:, :2])
    targets = []
    for grant in (
        GRANT_DEG,
        -GRANT_DEG,
    ):  # the planner may support faces this close to the overhang angle, or not
        found = judged_overhangs(placed, rules, spacing, grant)
        points = found.samples.points
        away, _ = tree.query(points[:, :2], distance_upper_bound=beside)
        rows = np.flatnonzero(np.isfinite(away) & (points[:, 2] > lowest))
        targets.append(points[rows[are_needed(found, rules, rows, strict=True)]])
    return np.concatenate(targets)


def _judged(body: SupportBody, above: Floats, build: Build, uncertain: float) -> list[Violation]:
    points = _samples(body)
    excess = _excess(points, above, body, build) - uncertain
    far = np.flatnonzero(excess > TOLERANCE)
    if len(far):
        beside = _largest_drift(points[far], body, build)
        lowest = float(points[far, 2].min()) - build.settings.overlap - _square_of(body, build)
        close = [_close_targets(build.parts[part], build, points[far], beside, lowest) for part in body.parts]
        again = _excess(points[far], np.concatenate(close), body, build) - uncertain
        excess[far] = np.minimum(excess[far], again)
        far = far[excess[far] > TOLERANCE]
    if not len(far):
        return []
    worst = far[excess[far].argmax()]
    place = place_words(points[worst])
    message = f"the point at {place} mm is {excess[worst]:.2f} mm too far sideways of all overhangs that it can carry"
    if np.isinf(excess[worst]):
        message = f"above the point at {place} mm no overhang needs support"
    message += f" ({len(far)} of {len(points)} points)"
    return [Violation(PROMISE, body.name, message)]


def _samples(body: SupportBody) -> Floats:
    """Return the highest points in each square of the plan, of the vertices and of points along edges."""
    vertices, corners = body.mesh.vertices, body.mesh.triangles
    start, end = corners.ravel(), corners[:, [1, 2, 0]].ravel()
    once = start < end
    start, end = start[once], end[once]
    way = sum(np.abs(axis[start] - axis[end]) for axis in np.ascontiguousarray(vertices.T))
    long = np.flatnonzero(way > _SPACING)
    along, _ = sample_segments(vertices[start[long]], vertices[end[long]], _SPACING)
    points = np.concatenate([vertices, along])
    return points[_highest(points)]


def _excess(points: Floats, above: Floats, body: SupportBody, build: Build) -> Floats:
    """Return how much farther each point is to the side than it may be, mm; at most 0 where it is not."""
    rules, sizes = build.settings.rules, build.settings.sizes_of(body)
    least = np.full(len(points), np.inf)
    if not len(above):
        return least
    limit = rules.drift_mm or np.inf
    square = _square_of(body, build)
    nearby = _nearby(square)

    def over(rows: Int64s, targets: Floats) -> Floats:
        """Return the excess of points over each of their targets."""
        own = points[rows, None]
        away = np.hypot(own[..., 0] - targets[..., 0], own[..., 1] - targets[..., 1])
        climb = targets[..., 2] - own[..., 2]
        allowed = np.minimum(rules.drift_ratio * climb if rules.drift_ratio > 0.0 else np.inf, limit)
        excess = away - np.maximum(allowed, 0.0) - nearby
        return np.asarray(np.where(climb > -build.settings.overlap - square, excess, np.inf))

    nearest = _nearest(points, above)
    every = np.arange(len(points))
    least = over(every, above[nearest]).min(axis=1)
    left = np.flatnonzero(least > TOLERANCE)
    rows = max(_CHUNK // len(above), 1)
    for at in range(0, len(left), rows):
        some = left[at : at + rows]
        least[some] = over(some, above[None]).min(axis=1)
    base = points[:, 2] <= sizes.base_height_mm
    return np.asarray(least - np.where(base, sizes.base_margin_mm, 0.0))


def _square_of(body: SupportBody, build: Build) -> float:
    """Return the side (mm) of the squares of the grid of a support."""
    return float(build.settings.sizes_of(body).square_mm or build.settings.reach_of(body))


def _nearby(square: float) -> float:
    """Return the distance (mm) that is granted everywhere, for squares of the grid of a side (mm)."""
    return float(np.sqrt(2.0) * square + _SPACING / np.sqrt(2.0))


def _largest_drift(points: Floats, body: SupportBody, build: Build) -> float:
    """Return the largest distance (mm) that some of the points may be away from overhangs of their parts."""
    rules = build.settings.rules
    square = _square_of(body, build)
    top = max(float(build.parts[part].mesh.vertices[:, 2].max()) for part in body.parts)
    climb = max(top - float(points[:, 2].min()), 0.0)
    steep = rules.drift_ratio * climb if rules.drift_ratio > 0.0 else np.inf
    return _nearby(square) + TOLERANCE + float(min(steep, rules.drift_mm or np.inf))


def _nearest(points: Floats, above: Floats) -> Int64s:
    """Return the targets that are nearest to each point in plan, ``(n, k)``; they decide nearly always."""
    from scipy.spatial import KDTree

    count = min(_FEW, len(above))
    found = KDTree(above[:, :2]).query(points[:, :2], k=count)[1]
    return np.asarray(found, np.int64).reshape(len(points), count)


def _highest(points: Floats) -> Int64s:
    """Return the highest of the points in each square of the plan."""
    square = np.floor(points[:, :2] / _CELL).astype(np.int64)
    square -= square.min(axis=0, initial=0)
    number = square[:, 0] * (int(square[:, 1].max(initial=0)) + 1) + square[:, 1]
    order = np.argsort(number, kind="stable")
    starts = np.flatnonzero(np.diff(number[order], prepend=-1))
    height = points[order, 2]
    top = (
        np.repeat(np.maximum.reduceat(height, starts), np.diff(starts, append=len(order)))
        if len(order)
        else height
    )
    highest = np.flatnonzero(height == top)
    _, first = np.unique(number[order[highest]], return_index=True)
    return np.asarray(order[highest[first]])
