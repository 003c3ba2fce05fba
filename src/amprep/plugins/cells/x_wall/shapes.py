"""The X of the x-wall as templates in the unit cube: solid with arms of some width, or as open sheets."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.model import Mesh, Template

# a ring of 16 points: each arm ends in three of them around a corner of the square, from the corner at (1, 1)
# counter-clockwise, and between two arms lies one near the centre
_CAP = [
    [15, 3, 7], [15, 7, 11],
    [0, 1, 2], [15, 0, 2], [15, 2, 3],
    [4, 5, 6], [3, 4, 6], [3, 6, 7],
    [8, 9, 10], [7, 8, 10], [7, 10, 11],
    [12, 13, 14], [11, 12, 14], [11, 14, 15],
]  # fmt: skip
_MIRRORED_SIDES = (5, 8, 9, 12)
"""Sides of the ring on x = 0 and y = 0: cut along the other diagonal, the one of the neighbour's side."""
_FACES = (2, 3, 6, 7, 10, 11, 14, 15)
"""Sides of the ring along the arms; in these are the windows."""

_FOOT, _HEAD = 0.05, 0.95
"""Heights of a window's lower and upper end."""


class Window(NamedTuple):
    """A rhombus through each arm, widest half way up: powder passes from one side of the wall to the other.

    Attributes
    ----------
    near
        Where it begins, as a distance from the cell's centre along x.
    post
        What it leaves of the arm's end, along x.
    """

    near: float
    post: float


def solid_x(
    arm: float, low: float, waist: float, high: float, hair: float = 0.0, window: Window | None = None
) -> Template:
    """Return a closed X.

    Parameters
    ----------
    arm
        Half of a wall's width along x, as a share of the square's side.
    low, waist, high
        How far the arms are drawn back from the square's sides at the bottom, half way up and at the top.
    hair
        How much thinner and shorter than that the arms are half way up.
    """
    heights, insets, arms = _sections(arm, low, waist, high, hair, middle=window is not None)
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
    return Template(_name(low, waist, high), Mesh(np.vstack(points), np.vstack(triangles).astype(np.int32)))


def surface_x(low: float, waist: float, high: float, window: Window | None = None) -> Template:
    """Return four open sheets that meet in the axis of the cell; the arguments are as for `solid_x`."""
    heights, insets, _ = _sections(0.0, low, waist, high, 0.0, middle=window is not None)
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
    return Template(_name(low, waist, high), mesh, surface=True)


def _window_corners(arms: list[float], near: float, far: float) -> Floats:
    """Corners of the windows, ``(32, 3)``: for each arm and each of its two faces near, foot, far and head.

    Parameters
    ----------
    arms
        As for `solid_x`, at the bottom, half way up and at the top.
    """
    along = np.array([near, (near + far) / 2, far, (near + far) / 2])
    height = np.array([0.5, _FOOT, 0.5, _HEAD])
    half = np.interp(height, [0.0, 0.5, 1.0], arms) / 2
    corners = []
    for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        for side in (-1, 1):
            plan = np.outer(along, (x, y)) + np.outer(side * half, (-y, x))
            corners.append(np.column_stack([plan + 0.5, height]))
    return np.vstack(corners)


def _window_faces() -> Iterator[NDArray[np.int64]]:
    """Yield the triangles of the arms' faces around the windows, and those inside them."""
    for k in range(4):
        right, left = 48 + 8 * k, 52 + 8 * k
        yield _pierced((4 * k - 1) % 16, 4 * k, 16, right)
        yield _pierced((4 * k + 3) % 16, 4 * k + 2, 16, left)[:, ::-1]
        for i in range(4):
            j = (i + 1) % 4
            yield np.array([[right + i, right + j, left + j], [right + i, left + j, left + i]])


def _pierced(near: int, far: int, level: int, window: int) -> NDArray[np.int64]:
    """Triangles between three pairs of points above one another, `level` apart, around the four of a window."""
    begin, foot, end, head = range(window, window + 4)
    n, f = near + level, far + level
    upper_near, upper_far = n + level, f + level
    return np.array([
        [near, far, foot], [near, foot, begin], [near, begin, n], [far, f, end], [far, end, foot],
        [upper_near, head, upper_far], [upper_near, begin, head], [upper_near, n, begin],
        [upper_far, end, f], [upper_far, head, end],
    ])  # fmt: skip


def _name(low: float, waist: float, high: float) -> str:
    if low == waist == high:
        return "joined" if low == 0.0 else "apart"
    if low == high:
        return "waisted"
    return "narrowing" if low < high else "widening"


def _sections(
    arm: float, low: float, waist: float, high: float, hair: float, *, middle: bool
) -> tuple[list[float], list[float], list[float]]:
    """Return the heights at which the sides bend, or all three with `middle`, and the insets and arms there."""
    if waist == (low + high) / 2 and hair == 0.0 and not middle:
        return [0.0, 1.0], [low, high], [arm, arm]
    return [0.0, 0.5, 1.0], [low, waist + hair, high], [arm, arm - hair, arm]


def _ring(arm: float, inset: float, height: float) -> Floats:
    """Outline of the X at one height, ``(16, 3)``: two strips along the diagonals, cut to the drawn-back square."""
    far, near = 1.0 - inset, inset
    outline = [
        (far, far - arm), (far, far), (far - arm, far), (0.5, 0.5 + arm),
        (near + arm, far), (near, far), (near, far - arm), (0.5 - arm, 0.5),
        (near, near + arm), (near, near), (near + arm, near), (0.5, 0.5 - arm),
        (far - arm, near), (far, near), (far, near + arm), (0.5 + arm, 0.5),
    ]  # fmt: skip
    return np.column_stack([np.array(outline), np.full(16, height)])


def _cross(inset: float, height: float) -> Floats:
    """Centre and four ends of the X without thickness, ``(5, 3)``."""
    far, near = 1.0 - inset, inset
    plan = [(0.5, 0.5), (far, far), (near, far), (near, near), (far, near)]
    return np.column_stack([np.array(plan), np.full(5, height)])


def _loft(sides: list[int]) -> NDArray[np.int64]:
    """Triangles between one ring and the next one up, on the given sides."""
    triangles = []
    for i in sides:
        j = (i + 1) % 16
        if i in _MIRRORED_SIDES:
            triangles += [[i, j, i + 16], [j, j + 16, i + 16]]
        else:
            triangles += [[i, j, j + 16], [i, j + 16, i + 16]]
    return np.array(triangles)
