"""Named support problems: generated scenes at the sizes of the thesis (chapter 4)."""

import numpy as np

from amprep.arrays import Bools, Bytes
from amprep.errors import InputError
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports import SupportProblem, Voxel

SIDES = {"A": 20, "B": 30, "C": 40, "D": 104, "E": 186}
"""Voxels along each side of the grid. Its ``(n + 1) n^2`` squares are as many as the thesis's within 5 %."""

BALLS = {"ball": [(0.5, 0.5, 0.65, 0.28)], "two-balls": [(0.5, 0.5, 0.76, 0.20), (0.55, 0.5, 0.32, 0.18)]}
"""Balls of each scene, ``(x, y, z, radius)`` as fractions of the grid's side."""

SCENES = (*BALLS, "plate")


def support_scene(name: str, side: int, *, capacity: int = 0) -> SupportProblem:
    """Return a scene as a support problem; the squares below faces flatter than 45 degrees are red.

    Parameters
    ----------
    name
        ``ball``: one ball in the air. ``two-balls``: two balls, one above the other. ``plate``: a slab above
        40 balls.
    side
        Voxels along each side of the grid, 1 mm each.
    capacity
        Largest number of paths through a square; 0 for no limit.

    Raises
    ------
    InputError
        If the scene is unknown.
    """
    if name not in SCENES:
        raise InputError(f"expected one of the scenes {', '.join(SCENES)}, got {name!r}")
    voxels, overhanging = np.zeros((side,) * 3, np.uint8), np.zeros((side,) * 3, np.bool_)
    for *centre, radius in BALLS.get(name, _random_balls()):
        _add_ball(voxels, overhanging, tuple(centre), radius)
    if name == "plate":
        _add_slab(voxels, overhanging)
    return problem_of_voxels(voxels, overhanging, capacity=capacity)


def problem_of_voxels(voxels: Bytes, overhanging: Bools, *, capacity: int) -> SupportProblem:
    """Return the problem whose red squares are the bottoms of overhanging voxels with room below, 1 mm a voxel.

    Parameters
    ----------
    voxels
        ``(nz, ny, nx)`` state of each voxel.
    overhanging
        ``(nz, ny, nx)`` voxels that need support where there is room below them; it is modified.
    capacity
        Largest number of paths through a square; 0 for no limit.
    """
    overhanging[0] = False
    overhanging[1:] &= voxels[:-1] == Voxel.FREE
    red = np.argwhere(overhanging).astype(np.int32)
    zeros = np.zeros(len(red), np.int32)
    nz, ny, nx = voxels.shape
    grid = Grid(np.zeros(3), 1.0, 1.0, (nz, ny, nx))
    return SupportProblem(grid, voxels, red, zeros, zeros, voxels[0] == Voxel.FREE, node_capacity=capacity)


def _random_balls() -> list[tuple[float, ...]]:
    """Return 40 balls of random position and radius; the seed is fixed."""
    rng = np.random.default_rng(1)
    balls = []
    for _ in range(40):
        radius = rng.uniform(0.03, 0.09)
        balls.append((*rng.uniform(0.08, 0.92, 2), rng.uniform(0.12, 0.72), radius))
    return balls


def _add_ball(voxels: Bytes, overhanging: Bools, centre: tuple[float, ...], radius: float) -> None:
    side = len(voxels)
    x, y, z = ((np.arange(side, dtype=np.float32) + 0.5) / side - middle for middle in centre)
    across = y[:, None] ** 2 + x**2
    inside = z[:, None, None] ** 2 + across <= radius**2
    voxels[inside] = Voxel.OCCUPIED
    overhanging |= inside & (z < 0)[:, None, None] & (across <= 0.5 * radius**2)


def _add_slab(voxels: Bytes, overhanging: Bools) -> None:
    side = len(voxels)
    low, left, right = int(0.85 * side), int(0.1 * side), int(0.9 * side)
    voxels[low : low + max(1, side // 20), left:right, left:right] = Voxel.OCCUPIED
    overhanging[low, left:right, left:right] = True


def count_graph(problem: SupportProblem) -> tuple[int, int]:
    """Return the numbers of squares and of edges: an edge leads down from each free voxel, straight or sideways."""
    nz, ny, nx = problem.voxels.shape
    free = problem.voxels == Voxel.FREE
    sideways = (free[:, 1:] & free[:, :-1]).sum() + (free[:, :, 1:] & free[:, :, :-1]).sum()
    return (nz + 1) * ny * nx, int(free.sum() + 2 * sideways)
