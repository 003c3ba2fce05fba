"""Cheapest paths down through a block of voxels."""

import numpy as np

from amprep.arrays import Bools, Floats

DIRECTIONS = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0))
"""``(dy, dx)`` from a square to the one below it: straight, +x, -x, +y, -y."""


def cheapest_path(prices: Floats, start: tuple[int, int], goal: tuple[int, int] | None) -> list[int] | None:
    """Return the directions of a cheapest path down through a block of voxels; None if there is no path.

    Parameters
    ----------
    prices
        ``(n, 5, ny, nx)`` price of the edge down from each square, by layer from the lowest to the highest and by
        direction; infinite where there is no edge.
    start
        y, x of the square above the highest layer.
    goal
        y, x of the square below the lowest layer; None for any square there.
    """
    cost = np.full(prices.shape[2:], np.inf)
    cost[start] = 0.0
    came = np.zeros((len(prices), *cost.shape), np.int8)
    for layer in range(len(prices) - 1, -1, -1):
        lower = np.full_like(cost, np.inf)
        for direction, (dy, dx) in enumerate(DIRECTIONS):
            upper, below = shifted(cost.shape, dy, dx)
            through = cost[upper] + prices[layer, direction][upper]
            better = through < lower[below]
            np.copyto(lower[below], through, where=better)
            np.copyto(came[layer][below], np.int8(direction), where=better)
        cost = lower
    end = goal if goal is not None else np.unravel_index(int(cost.argmin()), cost.shape)
    if not np.isfinite(cost[end]):
        return None
    y, x = (int(each) for each in end)
    directions: list[int] = []
    for layer in range(len(prices)):
        directions.append(int(came[layer, y, x]))
        y, x = y - DIRECTIONS[directions[-1]][0], x - DIRECTIONS[directions[-1]][1]
    return directions[::-1]


def edge_prices(free: Bools, vertical: float, oblique: float) -> Floats:
    """Return the prices ``(nz, 5, ny, nx)`` of the edges between free voxels, infinite where there is no edge.

    Of equal paths, those are a little cheaper that go sideways lower down.
    """
    prices = np.full((len(free), len(DIRECTIONS), *free.shape[1:]), np.inf)
    later = 1.0 + 1e-6 * np.arange(len(free))[:, None, None]
    for direction, (dy, dx) in enumerate(DIRECTIONS):
        upper, below = shifted(free.shape[1:], dy, dx)
        exists = free[:, *upper] & free[:, *below]
        price = vertical if direction == 0 else oblique * later
        prices[:, direction, *upper] = np.where(exists, price, np.inf)
    return prices


def shifted(shape: tuple[int, ...], dy: int, dx: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Return the upper squares of a plane from which a step ``dy, dx`` stays in the block, and the lower ones."""
    upper = tuple(slice(max(-d, 0), n - max(d, 0)) for d, n in zip((dy, dx), shape, strict=True))
    lower = tuple(slice(max(d, 0), n - max(-d, 0)) for d, n in zip((dy, dx), shape, strict=True))
    return (upper[0], upper[1]), (lower[0], lower[1])
