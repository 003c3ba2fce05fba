"""Two parallel rectangles of any orientation that cover a set in the plane (thesis 2.3, after Saha and Das)."""

from itertools import combinations

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.geometry.bounding.boxes.cells import cells_of
from amprep.geometry.bounding.boxes.orientation import about_z, angles_of, outline_of
from amprep.geometry.bounding.boxes.polygons import boxes_as_polygons
from amprep.geometry.bounding.boxes.two_boxes import Objective, TwoBoxSearch, two_boxes

_CELLS = 64
"""Cells along the longer side of the projection."""

_STEPS = 60
"""Angles that are tried in a right angle, besides those of the sides of the outline."""

_SIDES = 40
"""Greatest number of sides of the outline whose angles are tried, the longest first."""

_EVENTS = 16
"""Sets of at most as many points are tried at the directions of all pairs of points."""

_SECTIONS = 6
"""Golden sections between two neighbouring angles; each narrows the interval by 0.62."""

_APART = 2e-3
"""Least difference (rad) of two angles that are both chosen."""

_SHRINK = (5**0.5 - 1) / 2


def planar_items(vertices: Floats, triangles: Ints) -> Floats:
    """Return quadrilaterals ``(m, 4, 2)`` that contain the outline of the projection of a mesh along z.

    The projection is divided into cells, and the enclosing rectangle of what is in a cell is an item. Cells with
    neighbours on all four sides are left out: two rectangles that cover all other cells hardly ever leave them
    uncovered. They can where a slot is about as narrow as a cell, so what the rectangles leave uncovered must still
    be added to them (`shrink` does).
    """
    flat = vertices * [1.0, 1.0, 0.0]
    grid = cells_of(flat, triangles, _CELLS)
    met = np.pad(grid.met[:, :, 0], 1)
    inner = met[:-2, 1:-1] & met[2:, 1:-1] & met[1:-1, :-2] & met[1:-1, 2:]
    x0, y0, _, x1, y1, _ = grid.tight[:, :, 0][met[1:-1, 1:-1] & ~inner].T
    return np.stack([np.column_stack(corner) for corner in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))], axis=1)


def rectangles_at(items: Floats, angle: float, search: TwoBoxSearch) -> tuple[Floats, float]:
    """Return the best two rectangles after a rotation of the items, ``(k, 4)``, and the objective in mm2.

    Parameters
    ----------
    items
        ``(m, 4, 2)`` mm, the corners of quadrilaterals.
    angle
        Rotation about the origin, rad.
    search
        Objective and effort of the search for two boxes, here of height 1.
    """
    turned = items @ about_z(angle)[:2, :2].T
    count = len(items)
    boxes = np.column_stack((turned.min(axis=1), np.zeros(count), turned.max(axis=1), np.ones(count)))
    found, area = two_boxes(boxes_as_polygons(boxes), search)
    return found[:, [0, 1, 3, 4]], area


def best_angles(items: Floats, points: Floats, objective: Objective, count: int) -> list[float]:
    """Return rotations at which the best two rectangles are small: the best tried ones, and as many between them.

    Strategy: the smallest area as a function of the angle has its kinks where a side of a rectangle is along two
    points. Tried are the directions of the sides of the outline and equal steps; for few points the directions of
    all pairs, where the order of the points along an axis changes (Saha and Das). Around each of the best
    angles the interval is narrowed by golden sections. Angle 0 is always tried.

    Parameters
    ----------
    items
        As in `rectangles_at`.
    points
        ``(n, 2)`` mm, what the items contain; the corners of the projection.
    objective
        ``union`` or ``larger``, of areas.
    count
        Number of angles of each of the two kinds.
    """
    quick = TwoBoxSearch(objective, planes=16, rounds=1, starts=1)
    tried = np.unique(np.concatenate((_candidates(points), np.arange(_STEPS) * (np.pi / 2 / _STEPS))))
    areas = np.array([rectangles_at(items, angle, quick)[1] for angle in tried])
    order: list[int] = []
    for number in np.argsort(areas, kind="stable").tolist():
        if len(order) < count and (not order or np.abs(tried[order] - tried[number]).min() > _APART):
            order.append(number)
    narrowed = []
    for number in order:
        before = tried[number - 1] - (np.pi / 2 if number == 0 else 0.0)
        after = tried[(number + 1) % len(tried)] + (np.pi / 2 if number == len(tried) - 1 else 0.0)
        narrowed += [_narrowed(items, float(tried[number]), float(end), quick) for end in (before, after)]
    return [float(tried[n]) for n in order] + [angle for _, angle in sorted(narrowed)[:count]]


def _candidates(points: Floats) -> Floats:
    """Return angles at which a side of the outline, or of any two of few points, is along an axis."""
    if len(points) <= _EVENTS:
        ends = np.array(list(combinations(range(len(points)), 2)), np.int64).reshape(-1, 2)
        return angles_of(points[ends[:, 1]] - points[ends[:, 0]])
    outline = outline_of(points)
    sides = np.roll(outline, -1, axis=0) - outline
    return angles_of(sides[np.argsort(-np.linalg.norm(sides, axis=1), kind="stable")[:_SIDES]])


def _narrowed(items: Floats, low: float, high: float, search: TwoBoxSearch) -> tuple[float, float]:
    """Return the least area that golden sections find between two angles, and the angle."""
    best = (np.inf, low)
    inner = [high - _SHRINK * (high - low), low + _SHRINK * (high - low)]
    areas = [rectangles_at(items, angle, search)[1] for angle in inner]
    for _ in range(_SECTIONS):
        best = min(best, *zip(areas, inner, strict=True))
        if areas[0] <= areas[1]:
            high, inner[1], areas[1] = inner[1], inner[0], areas[0]
            inner[0] = high - _SHRINK * (high - low)
            areas[0] = rectangles_at(items, inner[0], search)[1]
        else:
            low, inner[0], areas[0] = inner[0], inner[1], areas[1]
            inner[1] = low + _SHRINK * (high - low)
            areas[1] = rectangles_at(items, inner[1], search)[1]
    return min(best, *zip(areas, inner, strict=True))
