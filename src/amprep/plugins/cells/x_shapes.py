"""The X of the x-wall as templates in the unit cube: solid with arms of some width, or as open sheets."""

import numpy as np
from numpy.typing import NDArray

from amprep.model import Mesh, Template

Floats = NDArray[np.float64]

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


def solid_x(arm: float, low: float, waist: float, high: float, hair: float = 0.0) -> Template:
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
    heights, insets, arms = _sections(arm, low, waist, high, hair)
    sections = zip(arms, insets, heights, strict=True)
    points = np.vstack([_ring(*section) for section in sections])
    cap = np.array(_CAP)
    triangles = [cap[:, ::-1], cap + 16 * (len(heights) - 1)]
    triangles += [_loft() + 16 * level for level in range(len(heights) - 1)]
    return Template(_name(low, waist, high), Mesh(points, np.vstack(triangles).astype(np.int32)))


def surface_x(low: float, waist: float, high: float) -> Template:
    """Return four open sheets that meet in the axis of the cell; the arguments are as for `solid_x`."""
    heights, insets, _ = _sections(0.0, low, waist, high, 0.0)
    points = [_cross(inset, height) for height, inset in zip(heights, insets, strict=True)]
    sheets = [[[0, i, i + 5], [0, i + 5, 5]] for i in range(1, 5)]
    triangles = [np.array(sheets).reshape(-1, 3) + 5 * level for level in range(len(heights) - 1)]
    mesh = Mesh(np.vstack(points), np.vstack(triangles).astype(np.int32))
    return Template(_name(low, waist, high), mesh, surface=True)


def _name(low: float, waist: float, high: float) -> str:
    if low == waist == high:
        return "joined" if low == 0.0 else "apart"
    if low == high:
        return "waisted"
    return "narrowing" if low < high else "widening"


def _sections(
    arm: float, low: float, waist: float, high: float, hair: float
) -> tuple[list[float], list[float], list[float]]:
    """Return the heights at which the sides bend, and the insets and arms there."""
    if waist == (low + high) / 2 and hair == 0.0:
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


def _loft() -> NDArray[np.int64]:
    """Triangles between one ring and the next one up."""
    triangles = []
    for i in range(16):
        j = (i + 1) % 16
        if i in _MIRRORED_SIDES:
            triangles += [[i, j, i + 16], [j, j + 16, i + 16]]
        else:
            triangles += [[i, j, j + 16], [i, j + 16, i + 16]]
    return np.array(triangles)
