"""Outlines of shapes inside the circle of a round build volume."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats

MOST_SIDES = 2000
"""Largest number of sides of the polygon that stands for a circle."""


class Circle(NamedTuple):
    """Centre ``(2,)`` and radius of a circle, mm."""

    centre: Floats
    radius: float


def outline_of(points: Floats) -> Floats:
    """Return the corners ``(k, 2)`` of the convex hull of points ``(n, 2)``; all points if they are on a line."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except (QhullError, ValueError):
        return points


def circle_sides(circle: Circle, tolerance: float) -> Floats:
    """Return a polygon that contains a circle, with all of its corners nearer to the circle than a tolerance.

    A side is a row (normal x, normal y, offset): inside, ``normal @ point <= offset``. The polygon has a multiple of
    four sides, two of them normal to each axis, and at most `MOST_SIDES`; then it may exceed the tolerance.
    """
    least = np.pi / np.arccos(circle.radius / (circle.radius + tolerance))
    sides = min(4 * int(np.ceil(least / 4.0)), MOST_SIDES)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    normals = np.column_stack((np.cos(angle), np.sin(angle)))
    return np.column_stack((normals, normals @ circle.centre + circle.radius))


def find_inside_circle(outline: Floats, circle: Circle, slack: float) -> Floats | None:
    """Return a translation ``(2,)`` after which an outline ``(k, 2)`` is inside a circle; None if there is none.

    The linear program minimises the distance t by which the outline is beyond a side of a polygon around the circle.

    Parameters
    ----------
    slack
        Length (mm) by which the outline may be outside.
    """
    from scipy.optimize import linprog

    sides = circle_sides(circle, slack / 2.0)
    reach = (outline @ sides[:, :2].T).max(axis=0)
    rows = np.column_stack((sides[:, :2], -np.ones(len(sides))))
    free = (None, None)
    found = linprog([0.0, 0.0, 1.0], A_ub=rows, b_ub=sides[:, 2] - reach, bounds=[free, free, free])
    if found.x is None:
        return None
    moved = outline + found.x[:2] - circle.centre
    return found.x[:2] if np.hypot(moved[:, 0], moved[:, 1]).max() <= circle.radius + slack else None
