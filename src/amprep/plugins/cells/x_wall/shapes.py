"""Make the X of the x-wall as a template in the unit cube: a solid, or open sheets."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.model import Mesh, Template

# The outline of the X at one height is a ring of 16 points, counter-clockwise from the corner at (1, 1): each arm ends
# in three points around a corner of the square, and one point near the centre is between two arms.
_CAP = [
    [15, 3, 7], [15, 7, 11],
    [0, 1, 2], [15, 0, 2], [15, 2, 3],
    [4, 5, 6], [3, 4, 6], [3, 6, 7],
    [8, 9, 10], [7, 8, 10], [7, 10, 11],
    [12, 13, 14], [11, 12, 14], [11, 14, 15],
]  # fmt: skip
_MIRRORED_SIDES = (5, 8, 9, 12)
"""Sides of the ring on x = 0 and y = 0, which are cut along the other diagonal to match the side of the neighbour."""
_FACES = (2, 3, 6, 7, 10, 11, 14, 15)
"""Sides of the ring along the arms, which contain the windows."""

_BOTTOM, _TOP = 0.05, 0.95
"""Heights of the lower and upper end of a window."""


class ArmWindow(NamedTuple):
    """A rhombus through each arm, widest at half the height, through which powder passes the wall.

    Attributes
    ----------
    near
        Distance of the window to the centre of the cell along x.
    post
        Length of the arm beyond the window along x.
    """

    near: float
    post: float


class Bends(NamedTuple):
    """Distance of the arms to the sides of the square: at the bottom, at half the height and at the top."""

    low: float
    waist: float
    high: float


def solid_x(arm: float, bends: Bends, thinning: float = 0.0, window: ArmWindow | None = None) -> Template:
    """Return a closed X. All lengths are fractions of the side of the square.

    Parameters
    ----------
    arm
        Half of the width of a wall along x.
    bends
        Insets of the arms.
    thinning
        Length by which the arms are thinner and shorter at half the height.
    window
        Windows in the arms, or None.
    """
    heights, insets, arms = _sections(arm, bends, thinning, middle=window is not None)
    sections = zip(arms, insets, heights, strict=True)
    points = [_ring(*section) for section in sections]
    cap, top = np.array(_CAP), len(heights) - 1
    triangles = [cap[:, ::-1], cap + 16 * top]
    sides = [side for side in range(16) if window is None or side not in _FACES]
    triangles += [_loft(sides) + 16 * level for level in range(top)]
    if window is not None:
        far = 0.5 - insets[1] - arms[1] / 2 - window.post
        points.append(_window_corners(arms, window.near, far))
        triangles += list(_window_faces())
    return Template(_name(bends), Mesh(np.vstack(points), np.vstack(triangles).astype(np.int32)))


def surface_x(bends: Bends, window: ArmWindow | None = None) -> Template:
    """Return four open sheets that meet in the axis of the cell; parameters as for `solid_x`."""
    heights, insets, _ = _sections(0.0, bends, 0.0, middle=window is not None)
    points = [_cross(inset, height) for height, inset in zip(heights, insets, strict=True)]
    if window is None:
        sheets = [[[0, i, i + 5], [0, i + 5, 5]] for i in range(1, 5)]
        triangles = [np.array(sheets).reshape(-1, 3) + 5 * level for level in range(len(heights) - 1)]
    else:
        far = 0.5 - insets[1] - window.post
        corners = _window_corners([0.0, 0.0, 0.0], window.near, far).reshape(4, 2, 4, 3)
        points.append(corners[:, 0].reshape(-1, 3))
        triangles = [_pierced(0, 1 + k, 5, 15 + 4 * k) for k in range(4)]
    mesh = Mesh(np.vstack(points), np.vstack(triangles).astype(np.int32))
    return Template(_name(bends), mesh, surface=True)


def _window_corners(arms: list[float], near: float, far: float) -> Floats:
    """Return the corners of the windows, ``(32, 3)``: near, bottom, far and top for both faces of each arm.

    Parameters
    ----------
    arms
        Half widths of a wall: at the bottom, at half the height and at the top.
    near, far
        Distances of both ends of the window to the centre along x.
    """
    along = np.array([near, (near + far) / 2, far, (near + far) / 2])
    height = np.array([0.5, _BOTTOM, 0.5, _TOP])
    half = np.interp(height, [0.0, 0.5, 1.0], arms) / 2
    corners = []
    for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        for side in (-1, 1):
            plan = np.outer(along, (x, y)) + np.outer(side * half, (-y, x))
            corners.append(np.column_stack([plan + 0.5, height]))
    return np.vstack(corners)


def _window_faces() -> Iterator[NDArray[np.int64]]:
    """Yield the triangles of the faces of the arms around the windows, and those inside the windows."""
    for k in range(4):
        right, left = 48 + 8 * k, 52 + 8 * k
        yield _pierced((4 * k - 1) % 16, 4 * k, 16, right)
        yield _pierced((4 * k + 3) % 16, 4 * k + 2, 16, left)[:, ::-1]
        for i in range(4):
            j = (i + 1) % 4
            yield np.array([[right + i, right + j, left + j], [right + i, left + j, left + i]])


def _pierced(near: int, far: int, level: int, window: int) -> NDArray[np.int64]:
    """Triangulate the face of an arm around a window.

    Parameters
    ----------
    near, far
        Points at both ends of the arm, at the bottom.
    level
        Difference in number to the points above them, at half the height and at the top.
    window
        First of the four corners of the window.
    """
    begin, foot, end, head = range(window, window + 4)
    n, f = near + level, far + level
    upper_near, upper_far = n + level, f + level
    return np.array([
        [near, far, foot], [near, foot, begin], [near, begin, n], [far, f, end], [far, end, foot],
        [upper_near, head, upper_far], [upper_near, begin, head], [upper_near, n, begin],
        [upper_far, end, f], [upper_far, head, end],
    ])  # fmt: skip


def _name(bends: Bends) -> str:
    low, waist, high = bends
    if low == waist == high:
        return "joined" if low == 0.0 else "apart"
    if low == high:
        return "waisted"
    return "narrowing" if low < high else "widening"


def _sections(
    arm: float, bends: Bends, thinning: float, *, middle: bool
) -> tuple[list[float], list[float], list[float]]:
    """Return the heights at which the sides bend (all three with `middle`), and insets and half widths there."""
    low, waist, high = bends
    if waist == (low + high) / 2 and thinning == 0.0 and not middle:
        return [0.0, 1.0], [low, high], [arm, arm]
    return [0.0, 0.5, 1.0], [low, waist + thinning, high], [arm, arm - thinning, arm]


def _ring(arm: float, inset: float, height: float) -> Floats:
    """Return the outline of the X at one height, ``(16, 3)``: two diagonal strips within the inset square."""
    far, near = 1.0 - inset, inset
    outline = [
        (far, far - arm), (far, far), (far - arm, far), (0.5, 0.5 + arm),
        (near + arm, far), (near, far), (near, far - arm), (0.5 - arm, 0.5),
        (near, near + arm), (near, near), (near + arm, near), (0.5, 0.5 - arm),
        (far - arm, near), (far, near), (far, near + arm), (0.5 + arm, 0.5),
    ]  # fmt: skip
    return np.column_stack([np.array(outline), np.full(16, height)])


def _cross(inset: float, height: float) -> Floats:
    """Return the centre and the four ends of the X without thickness, ``(5, 3)``."""
    far, near = 1.0 - inset, inset
    plan = [(0.5, 0.5), (far, far), (near, far), (near, near), (far, near)]
    return np.column_stack([np.array(plan), np.full(5, height)])


def _loft(sides: list[int]) -> NDArray[np.int64]:
    """Triangulate the given sides between a ring and the ring above it."""
    triangles = []
    for i in sides:
        j = (i + 1) % 16
        if i in _MIRRORED_SIDES:
            triangles += [[i, j, i + 16], [j, j + 16, i + 16]]
        else:
            triangles += [[i, j, j + 16], [i, j + 16, i + 16]]
    return np.array(triangles)
