"""Divide a solid by horizontal planes: the pieces between neighbouring planes, and which of them are connected."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, Ints

DIRECTION_COUNT = 12
"""Number of horizontal directions in which widths are measured first."""

_FINER = np.array([-2, -1, 1, 2])
"""Turns from the best direction, in fractions of the last step."""

_REFINEMENTS = 3


_LEAST_AREA = 1e-9
"""Twice the least area (mm2) of a cross-section."""


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


class _Crossings(NamedTuple):
    """Where planes cut triangles.

    Attributes
    ----------
    triangle, plane
        ``(c,)`` int64.
    ends
        ``(c, 2, 2)`` mm, both ends of the cut in plan, the solid to its left.
    key
        ``(c, 2)`` int64, numbers that equal ends of neighbouring triangles share.
    """

    triangle: Int64s
    plane: Int64s
    ends: Floats
    key: Int64s


def pieces_of_slabs(vertices: Floats, triangles: Ints, first: float, thickness: float) -> SlabPieces:
    """Return the pieces of a solid between the planes at heights ``first + i * thickness``.

    Strategy: the surface between two planes is connected as triangles are by their corners, and by the points where
    a plane cuts a common edge. So the pieces are the components of a graph of the vertices and of the cut
    triangles, one node for the side above and one for the side below each cut. Every outer loop of a cross-section
    is connected by surface with the piece that it bounds. Tunnels have surfaces of their own, whose loops run
    clockwise: their area is negative, which excludes them. Everything is sorting and counting over arrays.

    Parameters
    ----------
    vertices, triangles
        A closed mesh, ``(v, 3)`` mm and ``(t, 3)``.
    first
        Height (mm) of the lowest plane, below the mesh.
    thickness
        Distance (mm) of neighbouring planes.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    height = (vertices[:, 2] - first) / thickness
    slab = np.floor(height).astype(np.int64)
    corner = slab[triangles]
    low, high = corner.min(axis=1), corner.max(axis=1)
    cuts = _crossings(vertices, triangles, low, high, height)
    # nodes: vertices, then the surface below and above each cut, then the cuts' ends on the side below and above
    count, cut = len(vertices), np.arange(len(cuts.plane))
    below, above = count + cut, count + len(cut) + cut
    _, end = np.unique(cuts.key, return_inverse=True)
    end = end.reshape(-1, 2)
    ends = int(end.max(initial=-1)) + 1
    base = count + 2 * len(cut)
    flat = triangles[low == high]
    rows = [flat[:, 0], flat[:, 1], below, below, above, above]
    columns = [
        flat[:, 1],
        flat[:, 2],
        base + end[:, 0],
        base + end[:, 1],
        base + ends + end[:, 0],
        base + ends + end[:, 1],
    ]
    for side, nodes in ((-1, below), (0, above)):
        for k in range(3):  # corners in the slab on this side of the cut
            own = corner[cuts.triangle, k] == cuts.plane + side
            rows.append(nodes[own])
            columns.append(triangles[cuts.triangle[own], k])
    # between two cuts of one triangle, the side above the lower one is the side below the upper one
    following = np.flatnonzero(np.diff(cuts.triangle) == 0)
    rows.append(above[following])
    columns.append(below[following + 1])
    row, column = np.concatenate(rows), np.concatenate(columns)
    size = base + 2 * ends
    graph = coo_array((np.ones(len(row), np.int8), (row, column)), shape=(size, size))
    label = connected_components(graph, directed=False)[1].astype(np.int64)
    return _measured(vertices, slab, cuts, label, first, thickness)


def _crossings(vertices: Floats, triangles: Ints, low: Int64s, high: Int64s, height: Floats) -> _Crossings:
    """Return the cuts of all triangles by the planes between the slabs of their corners, plane by plane upwards."""
    crossed = np.flatnonzero(high > low)
    counts = high[crossed] - low[crossed]
    triangle = np.repeat(crossed, counts)
    up = np.arange(len(triangle)) - np.repeat(np.cumsum(counts) - counts, counts)
    plane = low[triangle] + 1 + up
    corners = triangles[triangle].astype(np.int64)
    at = height[corners] - plane[:, None]
    is_above = at >= 0
    # the corner that is alone on its side; the cut leads from one of its edges to the other
    alone = np.where(is_above.sum(axis=1) == 1, is_above.argmax(axis=1), is_above.argmin(axis=1))
    index = np.arange(len(triangle))
    ends, edges = [], []
    for turn in (1, 2):
        other = (alone + turn) % 3
        a, b = corners[index, alone], corners[index, other]
        h, g = at[index, alone], at[index, other]
        t = (h / (h - g))[:, None]
        ends.append(vertices[a, :2] * (1 - t) + vertices[b, :2] * t)
        edges.append(np.minimum(a, b) * len(vertices) + np.maximum(a, b))
    number = np.unique(np.concatenate(edges), return_inverse=True)[1].reshape(2, -1).T
    key = number * (int(plane.max(initial=0)) + 2) + plane[:, None]
    turned = ~is_above[index, alone]
    both = np.stack(ends, axis=1)
    both[turned] = both[turned, ::-1]
    return _Crossings(triangle, plane, both, key)


def _measured(
    vertices: Floats, slab: Int64s, cuts: _Crossings, label: Int64s, first: float, thickness: float
) -> SlabPieces:
    """Return the pieces of the components; `label` is that of vertices, and of the surface below and above cuts."""
    count, cut = len(vertices), len(cuts.plane)
    used, number = np.unique(label[: count + 2 * cut], return_inverse=True)
    below, above = number[count : count + cut], number[count + cut :]
    x, y = cuts.ends[:, :, 0], cuts.ends[:, :, 1]
    twice = x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]
    area = np.bincount(below, twice, len(used)) + np.bincount(above, twice, len(used))
    piece = np.where(area > _LEAST_AREA, np.cumsum(area > _LEAST_AREA) - 1, -1)
    height = np.zeros(len(used), np.int64)
    height[number[:count]], height[below], height[above] = slab, cuts.plane - 1, cuts.plane
    points = np.concatenate([vertices[:, :2], cuts.ends[:, 0], cuts.ends[:, 0]])
    owner = piece[np.concatenate([number[:count], below, above])]
    width, middle, size = _widths(points[owner >= 0], owner[owner >= 0])
    kept = height[piece >= 0]
    link = np.unique(np.column_stack([piece[above], piece[below]]), axis=0)
    centre = np.column_stack([middle, first + (kept + 0.5) * thickness])
    return SlabPieces(kept, width, centre, size, link[(link >= 0).all(axis=1)], piece[number[:count]])


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
