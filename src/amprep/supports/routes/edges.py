"""Rows of edges, ``(n, 7)`` int32 plane, y, x, direction, flow, capacity, part: what they meet, how they join."""

import numpy as np

from amprep.arrays import Int64s, Ints
from amprep.model.supports import DIRECTIONS
from amprep.supports.grid.red_squares import RedSquares


def merge_edges(edges: Ints) -> Ints:
    """Return each edge once, sorted: flows added, the greatest capacity, the first part."""
    key = keys_of(edges[:, :3]) * len(DIRECTIONS) + edges[:, 3]
    _, first, same = np.unique(key, return_index=True, return_inverse=True)
    flow = np.bincount(same, weights=edges[:, 4]).astype(np.int32)
    capacity = flow.copy()
    np.maximum.at(capacity, same, edges[:, 5])
    return np.column_stack([edges[first, :4], flow, capacity, edges[first, 6]]).astype(np.int32)


def keys_of(square: Ints) -> Int64s:
    """Return a number for each square ``(n, 3)``, in the order of plane, y, x."""
    plane, y, x = square.T.astype(np.int64)
    return np.asarray((plane << 40) | (y << 20) | x)


def lower_squares(edges: Ints) -> Ints:
    """Return the square ``(n, 3)`` plane, y, x at the lower end of each edge."""
    step = np.array(DIRECTIONS, np.int32)[edges[:, 3]]
    return edges[:, :3] + np.column_stack([np.full(len(edges), -1), step]).astype(np.int32)


def voxels_used(edges: Ints) -> Ints:
    """Return the two voxels (k, y, x) of each edge: below its upper square, above its lower one."""
    return np.stack([edges[:, :3] - (1, 0, 0), lower_squares(edges)], axis=1).reshape(-1, 3).astype(np.int32)


def voxel_users(edges: Ints) -> dict[tuple[int, int, int], int]:
    """Return the voxels (k, y, x) that edges use, each with a part whose they are."""
    parts = np.repeat(edges[:, 6], 2).tolist()
    return {(k, y, x): part for (k, y, x), part in zip(voxels_used(edges).tolist(), parts, strict=True)}


def voxels_below(square: Ints) -> Ints:
    """Return the voxel (k, y, x) below each square."""
    return np.asarray(square - (1, 0, 0), np.int32)


def no_voxels() -> Ints:
    """Return an empty list of voxels."""
    return np.empty((0, 3), np.int32)


def no_edges() -> Ints:
    """Return an empty list of edges."""
    return np.empty((0, 7), np.int32)


def part_of_edges(edges: Ints, red: RedSquares, reds: Ints) -> Ints:
    """Return for each edge the least part whose red square's support it belongs to (connected squares)."""
    component, of_red = components(edges, red.square[reds])
    least = np.full(int(max(component.max(initial=-1), of_red.max(initial=-1))) + 1, np.iinfo(np.int32).max)
    np.minimum.at(least, of_red, red.part[reds])
    return least[component].astype(np.int32)


def components(edges: Ints, squares: Ints) -> tuple[Ints, Ints]:
    """Label the connected supports: of each edge, and of each of `squares` ``(m, 3)``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    upper, lower = edges[:, :3], lower_squares(edges)
    _, number = np.unique(keys_of(np.concatenate([upper, lower, squares])), return_inverse=True)
    count, n = int(number.max(initial=-1)) + 1, len(edges)
    graph = coo_array((np.ones(n, np.int8), (number[:n], number[n : 2 * n])), shape=(count, count))
    label = connected_components(graph, directed=False)[1] if count else np.empty(0, np.int32)
    return label[number[:n]], label[number[2 * n :]]
