"""Records that the flow kernels share: the network, flow and capacities on it, and the residual network."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bytes, Int32s, Int64s

FlowCounts = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.int32]

UNBOUNDED = 1 << 30
"""Capacity of a square or an edge without a limit."""

UNREACHABLE = 1 << 30
"""Distance to the plate of a square from which no path leads there."""


class FlowNetwork(NamedTuple):
    """The squares of a support problem, in planes padded by one square on each side.

    Square (p, y, x) of the padded grid has the number ``u = p * stride + y * width + x``; its edge in direction d
    leads down to the square ``u - stride + offset[d]``.

    Attributes
    ----------
    passable
        ``(squares,)`` uint8, 1 where a path may arrive from above and continue downwards (or end, on the plate).
    offset
        ``(5,)`` int64, steps of `amprep.model.supports.DIRECTIONS` in square numbers.
    box
        ``(planes, 4)`` int64, least and greatest y, least and greatest x that paths can reach in each plane.
    stride, width
        Number of squares in a plane and in a row.
    """

    passable: Bytes
    offset: Int64s
    box: Int64s
    stride: int
    width: int


class Flow(NamedTuple):
    """Units of flow; kernels modify both arrays in place.

    Attributes
    ----------
    edge
        ``(squares, 5)`` flow down the edges of each square.
    square
        ``(squares,)`` flow through each square.
    """

    edge: FlowCounts
    square: FlowCounts


class Capacities(NamedTuple):
    """Greatest flow through squares above the plate and over edges; one number for all, or one for each.

    Attributes
    ----------
    square, edge
        int32; ``(1,)`` each, or ``(squares,)`` and ``(5 * squares,)`` with edge d of square u at ``5 * u + d``.
    each
        0 if one number applies to all, else 1: indices are multiplied by it.
    """

    square: Int32s
    edge: Int32s
    each: int


class ResidualNetwork(NamedTuple):
    """A network with the flow on it and its capacities; they imply the residual capacity of every arc."""

    network: FlowNetwork
    flow: Flow
    capacities: Capacities
