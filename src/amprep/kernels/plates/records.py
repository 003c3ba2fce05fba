"""Records of the search for plates: sampled outlines, fields, layouts and the search state."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Float32s, Floats, Int16s, Int32s, Int64s

UNITS = 256
"""Units of sampled lengths in a step of the fields."""

PHASES = 4
"""Fine steps, at which outlines are sampled, in a step of the fields."""

NONE, UNKNOWN = -2, -1
"""Entries of `FieldCache.first`: a pair without a field, and one whose field is not computed."""


class SampledOutlines(NamedTuple):
    """Outlines, relative to the centre of their enclosing boxes, sampled for fields of depth.

    They are in the order of increasing area; the edge of a round plate is last.

    Attributes
    ----------
    half
        ``(m, 2)`` mm, half the sides of the enclosing boxes.
    clearance
        ``(m,)`` mm; two outlines keep the lesser of theirs.
    distance
        Signed distances to the outlines at fine grid points, negative inside, in units. Those of an outline are in
        the order (phase along x, phase along y, x, y).
    first_distance, cells
        ``(m,)`` index of the first distance, ``(m, 2)`` number of steps from the centre to the last ones.
    point, shift
        ``(k, 2)`` fine grid points near the outlines, and what is added to a distance there to get that of the point of
        the outline, in units.
    first_point
        ``(m + 1,)``.
    corner, first_corner
        ``(c, 2)`` mm, corners of the convex hulls, and ``(m + 1,)``.
    step
        Step of the fields, mm.
    bed
        Index of the outline that stands for the edge of a round plate, and -1 without one.
    radius
        Radius (mm) within which outlines may be on a round plate.
    """

    half: Floats
    clearance: Floats
    distance: Int16s
    first_distance: Int64s
    cells: Int64s
    point: Int32s
    shift: Int16s
    first_point: Int64s
    corner: Floats
    first_corner: Int64s
    step: float
    bed: int
    radius: float


class FieldCache(NamedTuple):
    """Fields of depth of pairs of outlines, computed when they are first needed.

    The field of outlines ``a <= b`` and r quarter turns holds the depth, in units, of the overlap of a, turned r times,
    at the offsets of its centre from that of b, which is not turned.

    Attributes
    ----------
    values
        ``(capacity,)``; when it is full, all fields are dropped.
    first
        ``(m, m, 4)`` index of the first value, `UNKNOWN` or `NONE`.
    used
        ``(2,)`` number of values used, and number of times that all fields were dropped.
    """

    values: Int16s
    first: Int64s
    used: Int64s


class PlateShapes(NamedTuple):
    """Shapes: outlines turned by quarter turns, with the range of positions of their centres.

    Attributes
    ----------
    outline, quarter
        ``(s,)``.
    lo, hi
        ``(s, 2)`` mm.
    """

    outline: Int64s
    quarter: Int64s
    lo: Floats
    hi: Floats


class PlateLayout(NamedTuple):
    """Shape, plate and centre of each item; obstacles follow the items.

    Attributes
    ----------
    shape, plate
        ``(n,)``; `EVERYWHERE` for an obstacle on all plates.
    position
        ``(n, 2)`` mm.
    """

    shape: Int64s
    plate: Int64s
    position: Floats


class PlateState(NamedTuple):
    """Overlaps and weights of the guided search, and work arrays; all are modified.

    Attributes
    ----------
    overlap, weight
        ``(items, n)`` depth (mm) of the overlap of each item with the others and the obstacles, and its weight.
    random
        ``(1,)`` uint64 state of the random numbers, not 0.
    spent
        ``(4,)`` see `READ`.
    sums, turned
        ``(g,)`` float32 weighted overlap at the cells of a scan, and the part that is added in the order of columns.
    near, order
        ``(n,)`` items near the one that is moved, and the order of a round.
    cell, value
        ``(c,)`` candidate cells of a scan and their values.
    """

    overlap: Floats
    weight: Floats
    random: NDArray[np.uint64]
    spent: Int64s
    sums: Float32s
    turned: Float32s
    near: Int64s
    order: Int64s
    cell: Int64s
    value: Floats
