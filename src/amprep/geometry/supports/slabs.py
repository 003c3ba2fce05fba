"""Divide a solid by horizontal planes: the pieces between neighbouring planes, and which of them are connected."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, Ints
from amprep.geometry.slicing.contours import PlaneContours, SlicedMesh

DIRECTION_COUNT = 12
"""Number of horizontal directions in which widths are measured first."""

_FINER = np.array([-2, -1, 1, 2])
"""Turns from the best direction, in fractions of the last step."""

_REFINEMENTS = 3

_LEAST_AREA = 5e-10
"""Least area (mm2) of a cross-section."""


class SlabPieces(NamedTuple):
    """The connected pieces of the slabs between neighbouring planes.

    Attributes
    ----------
    slab
        ``(n,)`` int64, number of the slab of each piece, from the lowest.
    width
        ``(n,)`` mm, least width of the convex hull of a piece in plan.
    centre, size
        ``(n, 3)`` mm and ``(n, 2)`` mm, centre of its bounding box, and the size of that in plan.
    link
        ``(k, 2)`` int64: upper and lower piece, which a plane divides; each pair once.
    piece
        ``(v,)`` int64, piece of each vertex; -1 for vertices on shells of voids.
    """

    slab: Int64s
    width: Floats
    centre: Floats
    size: Floats
    link: Int64s
    piece: Int64s


def pieces_of_slabs(vertices: Floats, triangles: Ints, first: float, thickness: float) -> SlabPieces:
    """Return the pieces of a solid between the planes at heights ``first + i * thickness``.

    Strategy: planes divide triangles into strips. The surface between two planes is connected as its strips are, by
    common edges and by common corners there. Every outer contour in a plane is connected by surface with the piece that
    it bounds. Tunnels have surfaces of their own, whose contours run clockwise: their area is negative, which excludes
    them.

    Parameters
    ----------
    vertices, triangles
        A closed mesh, ``(v, 3)`` mm and ``(t, 3)``.
    first
        Height (mm) of the lowest plane, below the mesh.
    thickness
        Distance (mm) of neighbouring planes.
    """
    from amprep.kernels.slicing.contours import LevelRows, join_corners, join_slabs

    sliced = SlicedMesh(vertices, triangles, merge=False)
    planes = int((vertices[:, 2].max(initial=first) - first) // thickness) + 3
    heights = first + thickness * np.arange(planes, dtype=np.float64)
    level, low, high = sliced.levels(heights)
    count = high - low + 1
    rows = LevelRows(low, np.cumsum(count) - count)
    root, corner = np.arange(int(count.sum())), np.full(len(vertices), -1)
    join_slabs(sliced.linked, level, planes - 1, rows, root)
    join_corners(sliced.linked.triangles, level, rows, root, corner)
    number = np.append(np.cumsum(root == np.arange(len(root))) - 1, -1)  # -1 for vertices of no triangle
    contours = sliced.contours(heights)
    row = (rows.start - low)[contours.triangle] + contours.plane
    surface = _ConnectedSurface(number[root[row - 1]], number[root[row]], number[corner])
    return _measured(vertices, level, contours, surface, first, thickness)


class _ConnectedSurface(NamedTuple):
    """Number of the connected surface below and above each contour, and of that at each vertex, -1 for none."""

    below: Int64s
    above: Int64s
    vertex: Int64s


def _measured(
    vertices: Floats,
    slab: Int64s,
    contours: PlaneContours,
    surface: _ConnectedSurface,
    first: float,
    thickness: float,
) -> SlabPieces:
    """Return the pieces that connected surfaces bound."""
    below, above, vertex = surface
    count = int(max(each.max(initial=-1) for each in surface)) + 1
    area = np.bincount(below, contours.area, count) + np.bincount(above, contours.area, count)
    piece = np.append(np.where(area > _LEAST_AREA, np.cumsum(area > _LEAST_AREA) - 1, -1), -1)
    height = np.zeros(count, np.int64)
    height[vertex[vertex >= 0]] = slab[vertex >= 0]
    height[below], height[above] = contours.plane - 1, contours.plane
    points = np.concatenate([vertices[:, :2], contours.points, contours.points])
    length = np.diff(contours.first)
    owner = piece[np.concatenate([vertex, np.repeat(below, length), np.repeat(above, length)])]
    width, middle, size = _widths(points[owner >= 0], owner[owner >= 0])
    kept = height[piece[:-1] >= 0]
    link = np.unique(np.column_stack([piece[above], piece[below]]), axis=0)
    centre = np.column_stack([middle, first + (kept + 0.5) * thickness])
    return SlabPieces(kept, width, centre, size, link[(link >= 0).all(axis=1)], piece[vertex])


def _widths(points: Floats, owner: Int64s) -> tuple[Floats, Floats, Floats]:
    """Return the least width of the points ``(p, 2)`` of each owner, and centre and size of their box, ``(n, 2)``.

    The width is measured in a few directions, and then in directions ever nearer to the best one.
    """
    order = np.argsort(owner, kind="stable")
    points, owner = points[order], owner[order]
    begins = np.flatnonzero(np.diff(owner, prepend=-1))

    def extremes(angle: Floats) -> tuple[Floats, Floats]:
        along = points[:, 0] * np.cos(angle)[owner] + points[:, 1] * np.sin(angle)[owner]
        return np.minimum.reduceat(along, begins), np.maximum.reduceat(along, begins)

    step = np.pi / DIRECTION_COUNT
    best, least = np.zeros(len(begins)), np.full(len(begins), np.inf)
    for turns in (np.arange(DIRECTION_COUNT), *(_FINER / 4.0 ** (k + 1) for k in range(_REFINEMENTS))):
        middle = best
        for turn in turns:
            angle = middle + turn * step
            low, high = extremes(angle)
            better = high - low < least
            best, least = np.where(better, angle, best), np.where(better, high - low, least)
    sides = [extremes(np.full(len(begins), angle)) for angle in (0.0, np.pi / 2)]
    low, high = (np.column_stack(ends) for ends in zip(*sides, strict=True))
    return least, (low + high) / 2, high - low
