"""Records of the separation search: shapes, fields, walls, layouts and the search state."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Float32s, Floats, Int64s
from amprep.kernels.bounding.gjk import PieceArrays

PAIRS, NEXT = range(2)
"""Columns of `SeparationState.progress`: pairs in the list, next item of the round (-1: overlaps are unknown)."""


class NoFitSolid(NamedTuple):
    """The no-fit solid of two shapes as a union of convex polyhedra.

    Attributes
    ----------
    planes
        ``(k, 4)`` outward unit normals and offsets (mm) of all polyhedra, one after another.
    first_plane
        ``(p + 1,)`` index of the first plane of each polyhedron, and k.
    box
        ``(p, 6)`` mm, least and greatest corner of each polyhedron.
    """

    planes: Floats
    first_plane: Int64s
    box: Floats


class ContactShapes(NamedTuple):
    """Shapes as convex pieces, for the search of planes between them; mm from the position of the shape.

    Attributes
    ----------
    corners
        Corners of all pieces, and their boxes; the last box is not used.
    first
        ``(m + 1,)`` index of the first piece of each shape, and p.
    box
        ``(m, 6)`` least and greatest corner of each shape.
    normals, first_normal
        ``(k, 3)`` outward unit normals of all pieces, and ``(p + 1,)`` the index of the first one of each, and k.
    reach
        ``(k,)`` greatest extent of the piece along each of its normals.
    edges, first_edge
        ``(e, 3)`` unit vectors along edges of all pieces, and ``(p + 1,)`` the index of the first one of each, and e.
    clearance
        ``(m,)`` least distance of a moving shape from each shape.
    """

    corners: PieceArrays
    first: Int64s
    box: Floats
    normals: Floats
    first_normal: Int64s
    reach: Floats
    edges: Floats
    first_edge: Int64s
    clearance: Floats


class NoFitFields(NamedTuple):
    """Depth of no-fit solids, sampled on grids of one step.

    A depth is positive inside and negative outside near the boundary. Samples are stored in eight phases, the
    parities of their indices, so that every other sample along each axis is contiguous. The field of (b, a) is that of
    (a, b) mirrored in the origin, which is the same sequence of samples backwards; so only one of both is stored.

    Attributes
    ----------
    values
        All samples, in units of `scale`; float32, or int8 where there are many shapes.
    scale
        mm.
    first
        ``(m, m)`` index of the first sample of a pair; -1 for a pair without a field.
    stride
        ``(m, m)`` 1, or -1 for a pair that is read backwards.
    origin
        ``(m, m, 3)`` mm, offset of the first sample.
    cells
        ``(m, m, 3)`` number of samples along each axis in one phase.
    step
        Distance of samples, mm.
    """

    values: NDArray[Any]
    scale: float
    first: Int64s
    stride: Int64s
    origin: Floats
    cells: Int64s
    step: float


class PositionRange(NamedTuple):
    """Positions at which shapes are inside the build volume.

    Attributes
    ----------
    lo, hi
        ``(m, 3)`` mm, least and greatest position of each shape.
    radius
        Radius (mm) of the circle that contains the outlines; 0 for a box-shaped build volume.
    centre
        ``(2,)`` mm, its centre.
    outline
        ``(k, 2)`` mm, corners of the outlines of all shapes, one after another.
    first
        ``(m + 1,)`` index of the first corner of each outline, and k.
    """

    lo: Floats
    hi: Floats
    radius: float
    centre: Floats
    outline: Floats
    first: Int64s


class ShapeLayout(NamedTuple):
    """Shape, build and position of each item; obstacles follow the items.

    Attributes
    ----------
    shape
        ``(n,)`` int64.
    build
        ``(n,)`` int64; `EVERYWHERE` for an obstacle in every build.
    position
        ``(n, 3)`` mm.
    """

    shape: Int64s
    build: Int64s
    position: Floats


class SeparationState(NamedTuple):
    """Overlaps and weights of the guided search, and work arrays; all are modified.

    Attributes
    ----------
    overlap, weight
        ``(items, n)`` depth (mm) of the overlap of each item with the others and the obstacles, and its weight.
    outside, outside_weight
        ``(items,)`` length (mm) by which an item is outside the circle, and its weight.
    touching
        ``(items,)`` number of items and obstacles that an item overlaps.
    pairs
        ``(p, 2)`` int32 list of the pairs that overlap or have a weight above 1; p is the number of all pairs.
    listed
        ``(items, n)`` whether a pair (i, j) with j < i or an obstacle j is in the list.
    progress
        ``(2,)`` see `PAIRS`.
    least
        ``(1,)`` total overlap (mm) of the best layout so far.
    random
        ``(1,)`` uint64 state of the random numbers, not 0.
    spent
        ``(4,)`` see `READ`.
    sums
        ``(g,)`` float32 weighted overlap at the cells of a scan.
    near, frame
        ``(n, 5)`` and ``(n, 4)`` fields near the item that is moved: index of the first sample, stride and numbers of
        samples in one phase; position (mm) of the first sample and weight of the overlap in units of the samples.
    order
        ``(items,)`` order of a round.
    cell, value
        ``(c,)`` candidate cells of a scan and their values.
    """

    overlap: Floats
    weight: Floats
    outside: Floats
    outside_weight: Floats
    touching: Int64s
    pairs: NDArray[np.int32]
    listed: Bools
    progress: Int64s
    least: Floats
    random: NDArray[np.uint64]
    spent: Int64s
    sums: Float32s
    near: Int64s
    frame: Floats
    order: Int64s
    cell: Int64s
    value: Floats
