"""Boxes in rows, rows in layers, layers in builds, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s

ROUNDING = 1e-9


class RowScratch(NamedTuple):
    """Work arrays of `fill_rows` for m boxes.

    Attributes
    ----------
    rows
        ``(m, 6)`` of each row: free length, depth, height, start across, start up, build.
    layers
        ``(m, 4)`` of each layer: free depth, height, start up, build.
    left
        ``(m,)`` free height of each build.
    """

    rows: Floats
    layers: Floats
    left: Floats


# Strategy. First fit on three levels: each box goes into the first row with enough length, depth and height; else it
# starts a row in the first layer with enough depth and height; else a layer in the first build with enough height;
# else a build. A row is as deep, and a layer as high, as the box that starts it. Time: boxes times rows.
@njit(cache=True)
def fill_rows(
    order: Int64s,
    size: Floats,
    room: Floats,
    flat: bool,
    builds: int,
    build: Int64s,
    position: Floats,
    scratch: RowScratch,
) -> None:
    """Put each box first fit into a row, else a row into a layer, else a layer into a build.

    Parameters
    ----------
    order
        ``(m,)`` the boxes, in this order.
    size, position
        ``(n, 3)`` mm: along a row, across it, up. `position` is filled for the boxes that are placed.
    room
        ``(3,)`` mm, in the same order of axes.
    flat
        Whether a build has one layer only.
    builds
        Greatest number of builds.
    build
        ``(n,)`` filled for the boxes that are placed.
    scratch
        Modified in place.
    """
    rows, layers, left = scratch
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
        position[item, 0], position[item, 1], position[item, 2] = (
            room[0] - rows[row, 0],
            rows[row, 3],
            rows[row, 4],
        )
        rows[row, 0] -= size[item, 0]
