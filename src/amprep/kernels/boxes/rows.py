"""Boxes in rows, rows in layers, layers in builds, first fit, compiled."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s

ROUNDING = 1e-9


@njit(cache=True)
def fill_rows(
    order: Int64s,
    size: Floats,
    room: Floats,
    flat: bool,
    builds: int,
    build: Int64s,
    place: Floats,
    rows: Floats,
    layers: Floats,
    left: Floats,
) -> None:
    """Put each box first fit into a row, else a row into a layer, else a layer into a build.

    Parameters
    ----------
    order
        ``(m,)`` which boxes, in this order.
    size, place
        ``(n, 3)`` mm: along a row, across it, up; `place` is filled for what is placed.
    room
        ``(3,)`` mm, in the same order.
    flat
        Whether there is one layer a build.
    builds
        Most builds.
    build
        ``(n,)`` filled for what is placed.
    rows, layers, left
        ``(m, 6)``, ``(m, 4)`` and ``(m,)`` work arrays. Of each row: free length, depth, height, start across and
        up, build; of each layer: free depth, height, start up, build; of each build its free height.
    """
    row_count, layer_count, build_count = 0, 0, 0
    for item in order:
        long, deep, high = size[item, 0] - ROUNDING, size[item, 1] - ROUNDING, size[item, 2] - ROUNDING
        row = 0
        while row < row_count and (rows[row, 0] < long or rows[row, 1] < deep or rows[row, 2] < high):
            row += 1
        if row == row_count:
            layer = 0
            while layer < layer_count and (layers[layer, 0] < deep or layers[layer, 1] < high):
                layer += 1
            if layer == layer_count:
                number = 0
                while number < build_count and left[number] < high:
                    number += 1
                if number == builds:
                    continue
                if number == build_count:
                    left[number] = room[2]
                    build_count += 1
                layers[layer, 0], layers[layer, 1] = room[1], size[item, 2]
                layers[layer, 2], layers[layer, 3] = room[2] - left[number], number
                left[number] = -np.inf if flat else left[number] - size[item, 2]
                layer_count += 1
            rows[row, 0], rows[row, 1], rows[row, 2] = room[0], size[item, 1], layers[layer, 1]
            rows[row, 3], rows[row, 4] = room[1] - layers[layer, 0], layers[layer, 2]
            rows[row, 5] = layers[layer, 3]
            layers[layer, 0] -= size[item, 1]
            row_count += 1
        build[item] = int(rows[row, 5])
        place[item, 0], place[item, 1], place[item, 2] = room[0] - rows[row, 0], rows[row, 3], rows[row, 4]
        rows[row, 0] -= size[item, 0]
