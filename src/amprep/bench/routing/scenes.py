"""Generated scenes for support routers, at the thesis's sizes (chapter 4)."""

import numpy as np

from amprep.arrays import Bools, Bytes
from amprep.errors import InputError
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports import SupportProblem, Voxel

SIDES = {"A": 20, "B": 30, "C": 40, "D": 104, "E": 186}
"""Cubes along each side of the grid: its ``(n + 1) n^2`` squares are as many as the thesis's within 5 %."""

BALLS = {"ball": [(0.5, 0.5, 0.65, 0.28)], "two-balls": [(0.5, 0.5, 0.76, 0.20), (0.55, 0.5, 0.32, 0.18)]}
"""Scene -> balls ``(x, y, z, radius)`` in units of the grid's side."""

SCENES = (*BALLS, "plate")


def scene(name: str, side: int, *, capacity: int = 0) -> SupportProblem:
    """Return a scene on a voxel of `side` voxels; red are the squares under what is flatter than 45 degrees.

    ``ball`` hangs in the air, ``two-balls`` hang one above the other, ``plate`` is a slab over 40 balls.

    Raises
    ------
    InputError
        For an unknown scene.
    """
    if name not in SCENES:
        raise InputError(f"expected one of the scenes {', '.join(SCENES)}, got {name!r}")
    voxels, needy = np.zeros((side,) * 3, np.uint8), np.zeros((side,) * 3, np.bool_)
    for *centre, radius in BALLS.get(name, _crowd()):
        _add_ball(voxels, needy, tuple(centre), radius)
    if name == "plate":
        _add_slab(voxels, needy)
    needy[0] = False
    needy[1:] &= voxels[:-1] == Voxel.FREE
    red = np.argwhere(needy).astype(np.int32)
    nothing = np.zeros(len(red), np.int32)
    frame = Grid(np.zeros(3), 1.0, 1.0, (side, side, side))
    return SupportProblem(
        frame, voxels, red, nothing, nothing, voxels[0] == Voxel.FREE, node_capacity=capacity
    )


def _crowd() -> list[tuple[float, ...]]:
    """Return 40 balls of random place and radius, always the same."""
    rng = np.random.default_rng(1)
    balls = []
    for _ in range(40):
        radius = rng.uniform(0.03, 0.09)
        balls.append((*rng.uniform(0.08, 0.92, 2), rng.uniform(0.12, 0.72), radius))
    return balls


def _add_ball(voxels: Bytes, needy: Bools, centre: tuple[float, ...], radius: float) -> None:
    side = len(voxels)
    x, y, z = ((np.arange(side, dtype=np.float32) + 0.5) / side - middle for middle in centre)
    across = y[:, None] ** 2 + x**2
    inside = z[:, None, None] ** 2 + across <= radius**2
    voxels[inside] = Voxel.OCCUPIED
    needy |= inside & (z < 0)[:, None, None] & (across <= 0.5 * radius**2)


def _add_slab(voxels: Bytes, needy: Bools) -> None:
    side = len(voxels)
    low, left, right = int(0.85 * side), int(0.1 * side), int(0.9 * side)
    voxels[low : low + max(1, side // 20), left:right, left:right] = Voxel.OCCUPIED
    needy[low, left:right, left:right] = True


def count_graph(problem: SupportProblem) -> tuple[int, int]:
    """Return the numbers of all squares and of all edges: pairs of free voxels, equal or side by side."""
    nz, ny, nx = problem.voxels.shape
    white = problem.voxels == Voxel.FREE
    sideways = (white[:, 1:] & white[:, :-1]).sum() + (white[:, :, 1:] & white[:, :, :-1]).sum()
    return (nz + 1) * ny * nx, int(white.sum() + 2 * sideways)
