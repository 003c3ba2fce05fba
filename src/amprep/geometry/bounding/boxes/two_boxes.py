"""Two axis-parallel boxes that cover a set of polygons (thesis 2.3, after Bespamyatnikh and Segal)."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, Ints
from amprep.geometry.bounding.boxes.polygons import ConvexPolygons

Objective = Literal["larger", "union"]

_SAMPLE = 2000
"""Corners whose coordinates show whether there are few distinct ones."""

_SWEPT = 256
"""Distinct coordinates that the search for the smallest larger box tries at least; its time is their square."""

_LOCAL = 9
"""Planes of one round across the gap on both sides of a plane."""


class TwoBoxSearch(NamedTuple):
    """Settings of the search for two boxes.

    Attributes
    ----------
    objective
        ``union``: least volume of the union; ``larger``: least volume of the larger box.
    planes
        Greatest number of planes along an axis at which the faces of the first box are tried.
    rounds
        Rounds in which the planes near the best boxes are replaced by finer ones.
    starts
        Number of different pairs of boxes that are refined.
    """

    objective: Objective = "union"
    planes: int = 48
    rounds: int = 5
    starts: int = 2


def two_boxes(
    polygons: ConvexPolygons,
    search: TwoBoxSearch,
    *,
    preferred: Sequence[Floats] = ((), (), ()),  # type: ignore[assignment]
    covered: Floats | None = None,
    limit: float = np.inf,
) -> tuple[Floats, float]:
    """Return boxes that cover the polygons, ``(2, 6)``, and the objective; no boxes if none are below the limit.

    Strategy: one of the boxes touches three faces of the enclosing box; its three free faces are tried on
    planes. What is beyond a plane is enclosed exactly, triangles clipped, so every pair that is tried covers the
    polygons. Then finer planes around the best pairs are tried, round by round.

    If the corners have at most `planes` distinct coordinates along each axis (256 for the objective ``larger``,
    whose search takes only quadratic time), all are tried. For points, the result is then optimal, because the
    faces of an optimal pair can be moved inwards to points. For polygons and any planes: moving the free faces of
    the first box of an optimal pair outwards to the next planes leaves less for the second box, so the result
    exceeds the optimum by at most the volume that this adds to the first box.

    Parameters
    ----------
    polygons
        At least one polygon.
    search
        Objective and effort.
    preferred
        For each axis, coordinates that are tried first, best first; for example those of flat faces.
    covered
        ``(k, 6)``, at most two boxes whose volume does not count; only for the objective ``union``.
    limit
        Only a smaller union is of use; the search is faster with it.
    """
    known = np.empty((0, 6)) if covered is None else np.ascontiguousarray(covered)
    bounds = polygons.bounds
    exact = search.planes if search.objective == "union" else max(search.planes, _SWEPT)
    planes = []
    for axis in range(3):
        distinct = _distinct(polygons.points[:, axis], exact)
        steps = _planes(bounds[axis::3], search.planes, preferred[axis])
        planes.append(steps if distinct is None else distinct)
    slack = 1.0 if search.starts == 1 else 1.02
    found = _search(polygons, planes, search.objective, known, limit, slack=slack)
    best = found[np.argmin(found[:, 0])]
    for choice in _different(found, search.starts):
        row, around = found[choice], planes
        for _ in range(search.rounds):
            around = _finer(around, row[1:7], bounds, preferred)
            finer = _search(polygons, around, search.objective, known, row[0], choice)[choice]
            row = finer if finer[0] < row[0] else row
        best = row if row[0] < best[0] else best
    if not np.isfinite(best[0]):
        return np.empty((0, 6)), np.inf
    return best[1:].reshape(2, 6), float(best[0])


def _search(
    polygons: ConvexPolygons,
    planes: Sequence[Floats],
    objective: Objective,
    covered: Floats,
    limit: float = np.inf,
    only: int = -1,
    slack: float = 1.0,
) -> Floats:
    """Return the objective and both boxes for each choice of free faces, ``(20, 13)``; inf where there is nothing."""
    from amprep.kernels.bounding.boxes.half_spaces import boxes_beyond
    from amprep.kernels.bounding.boxes.two_boxes import search_larger, search_union

    rows, counts = _padded(planes)
    beyond = np.empty((6, rows.shape[1], 6))
    boxes_beyond(*polygons, rows, counts, beyond)
    found = np.empty((20, 13))
    if objective == "larger":
        search_larger(rows, counts, beyond, found)
    else:
        search_union(rows, counts, beyond, covered, limit, slack, only, found)
    return found


def _padded(planes: Sequence[Floats]) -> tuple[Floats, Int64s]:
    counts = np.array([len(row) for row in planes])
    rows = np.zeros((3, counts.max()))
    for axis, row in enumerate(planes):
        rows[axis, : len(row)] = row
    return rows, counts


def _distinct(coordinates: Floats, most: int) -> Floats | None:
    """Return the distinct coordinates in order; None if there are more than `most`."""
    if len(np.unique(coordinates[:_SAMPLE])) > most:
        return None
    distinct = np.unique(coordinates)
    return _at_least_two(distinct) if len(distinct) <= most else None


def _planes(ends: Floats, most: int, preferred: Floats) -> Floats:
    """Return sorted planes: preferred ones, and equal steps between the ends."""
    first = np.asarray(preferred, np.float64)[: most // 2]
    steps = np.linspace(ends[0], ends[1], max(most - len(first), 2))
    return np.unique(np.concatenate((first[(first > ends[0]) & (first < ends[1])], steps)))


def _at_least_two(planes: Floats) -> Floats:
    """Return the planes; where a set is flat, with a second plane just above it."""
    return planes if len(planes) > 1 else np.array([planes[0], np.nextafter(planes[0], np.inf) + 1e-9])


def _different(found: Floats, count: int) -> list[int]:
    """Return the best choices of faces, of those with the same two boxes one."""
    chosen: list[int] = []
    for number in np.argsort(found[:, 0], kind="stable").tolist():
        row = found[number]
        pairs = (row[1:], np.roll(row[1:], 6))
        new = not any(np.allclose(found[old, 1:], pair) for old in chosen for pair in pairs)
        if len(chosen) < count and np.isfinite(row[0]) and new:
            chosen.append(number)
    return chosen


def _finer(
    planes: Sequence[Floats], box: Floats, bounds: Floats, preferred: Sequence[Floats]
) -> list[Floats]:
    """Return planes across the gaps beside the faces of a box, with the ends of the enclosing box."""
    finer = []
    for axis, row in enumerate(planes):
        chosen = [bounds[axis::3]]
        for face in box[axis::3]:
            at = int(np.searchsorted(row, face))
            low, high = row[max(at - 1, 0)], row[min(at + 1, len(row) - 1)]
            near = np.asarray(preferred[axis], np.float64)
            chosen += [
                np.linspace(low, high, _LOCAL),
                near[(near > low) & (near < high)][:_LOCAL],
                np.array([face]),
            ]
        finer.append(_at_least_two(np.unique(np.concatenate(chosen))))
    return finer


def flat_coordinates(vertices: Floats, triangles: Ints) -> list[Floats]:
    """Return for each axis the coordinates of triangles normal to it, those of the largest area first."""
    corners = [np.ascontiguousarray(vertices[:, axis])[triangles] for axis in range(3)]
    chosen = []
    for axis in range(3):
        a, b, c = corners[axis].T
        flat = np.flatnonzero((a == b) & (b == c))
        u, v = (corners[other][flat] for other in range(3) if other != axis)
        area = np.abs((u[:, 1] - u[:, 0]) * (v[:, 2] - v[:, 0]) - (u[:, 2] - u[:, 0]) * (v[:, 1] - v[:, 0]))
        at, number = np.unique(a[flat], return_inverse=True)
        chosen.append(at[np.argsort(-np.bincount(number, area, len(at)), kind="stable")])
    return chosen
