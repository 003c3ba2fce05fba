"""Trace the contours in which horizontal planes cut a mesh, and connect the pieces of surface between the planes.

Strategy. A plane cuts a triangle in a segment from an edge that leads down through it to one that leads up, and the
twin of the latter leads down in the next triangle. So a contour is a cycle that is walked from triangle to triangle,
without any search. Rows are pairs of a triangle and a plane (or a slab between planes); those of a triangle follow one
another.
"""

from typing import NamedTuple

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import kernel
from amprep.kernels.meshes.components import root_of


class LinkedTriangles(NamedTuple):
    """Triangles with their neighbours.

    Attributes
    ----------
    points, triangles
        ``(v, 3)`` mm and ``(m, 3)``.
    twin
        ``(3 m,)`` the half-edge in the neighbour of each half-edge, negative for none.
    """

    points: Floats
    triangles: Int64s
    twin: Int64s


class LevelRows(NamedTuple):
    """Rows of pairs of a triangle and each level of its range; levels are planes, or slabs named by the plane below.

    Attributes
    ----------
    first, start
        ``(m,)`` first level of each triangle, and row of that level.
    """

    first: Int64s
    start: Int64s


class TracedContours(NamedTuple):
    """Arrays for contours, as long as there are rows; filled in place.

    Attributes
    ----------
    points
        ``(r, 2)`` mm, points of one contour after the other.
    first
        ``(r + 1,)`` first point of each contour.
    plane, triangle
        ``(r,)`` plane of each contour, and a triangle that it crosses.
    area
        ``(r,)`` mm2, negative for holes.
    """

    points: Floats
    first: Int64s
    plane: Int64s
    triangle: Int64s
    area: Floats


@kernel
def trace_contours(
    mesh: LinkedTriangles,
    heights: Floats,
    level: Int64s,
    rows: LevelRows,
    is_seen: Bools,
    found: TracedContours,
) -> int:
    """Walk along all contours, the inside to their left, and return their number.

    A contour that meets an open edge ends there.

    Parameters
    ----------
    mesh
        The triangles.
    heights, level
        ``(k,)`` mm, ascending, and ``(v,)`` the highest plane at or below each vertex, -1 for none.
    rows
        Planes that cut each triangle.
    is_seen
        ``(r,)`` False for all rows, modified in place.
    found
        Filled in place.
    """
    points, triangles = mesh.points, mesh.triangles
    contours, count = 0, 0
    for begin in range(len(rows.first)):
        last = rows.start[begin + 1] if begin + 1 < len(rows.first) else len(is_seen)
        for first_row in range(rows.start[begin], last):
            if is_seen[first_row]:
                continue
            plane = rows.first[begin] + first_row - rows.start[begin]
            height = heights[plane]
            found.first[contours], found.plane[contours], found.triangle[contours] = count, plane, begin
            own, t, row = count, begin, first_row
            twice_area = 0.0
            while not is_seen[row]:
                is_seen[row] = True
                up = 0
                for c in range(3):
                    a, b = triangles[t, c], triangles[t, (c + 1) % 3]
                    is_above, is_next_above = level[a] >= plane, level[b] >= plane
                    if is_next_above and not is_above:
                        up = 3 * t + c
                    elif is_above and not is_next_above:
                        fraction = (height - points[b, 2]) / (points[a, 2] - points[b, 2])
                        found.points[count, 0] = points[b, 0] + fraction * (points[a, 0] - points[b, 0])
                        found.points[count, 1] = points[b, 1] + fraction * (points[a, 1] - points[b, 1])
                if count > own + 1:
                    ux = found.points[count - 1, 0] - found.points[own, 0]
                    uy = found.points[count - 1, 1] - found.points[own, 1]
                    vx = found.points[count, 0] - found.points[own, 0]
                    vy = found.points[count, 1] - found.points[own, 1]
                    twice_area += ux * vy - uy * vx
                count += 1
                if mesh.twin[up] < 0:
                    break
                t = mesh.twin[up] // 3
                row = rows.start[t] + plane - rows.first[t]
            found.area[contours] = twice_area / 2.0
            contours += 1
    found.first[contours] = count
    return contours


@kernel
def join_slabs(mesh: LinkedTriangles, level: Int64s, slabs: int, rows: LevelRows, parent: Int64s) -> None:
    """Connect the rows of triangles and slabs that share an edge there; equal parents tell what is connected.

    Parameters
    ----------
    mesh, level
        See `trace_contours`.
    slabs
        Number of slabs between planes.
    rows
        Slabs that each triangle meets.
    parent
        ``(r,)`` the number of each row; then that of its root.
    """
    triangles = mesh.triangles
    for half in range(triangles.size):
        twin = mesh.twin[half]
        if twin <= half:
            continue
        t, other = half // 3, twin // 3
        one, two = level[triangles[t, half % 3]], level[triangles[t, (half + 1) % 3]]
        for slab in range(max(min(one, two), 0), min(max(one, two), slabs - 1) + 1):
            a = root_of(parent, rows.start[t] + slab - rows.first[t])
            b = root_of(parent, rows.start[other] + slab - rows.first[other])
            parent[max(a, b)] = min(a, b)
    for row in range(len(parent)):
        parent[row] = root_of(parent, row)


@kernel
def join_corners(
    triangles: Int64s, level: Int64s, rows: LevelRows, parent: Int64s, corner_row: Int64s
) -> None:
    """Connect the rows of triangles that share a corner in a slab, too.

    Parameters
    ----------
    triangles
        ``(m, 3)``.
    level, rows
        See `join_slabs`; here each triangle meets the slabs of all its corners.
    parent
        ``(r,)`` root of each row, modified in place.
    corner_row
        ``(v,)`` of -1; then the root of the rows at each vertex, -1 for vertices of no triangle.
    """
    for t in range(len(triangles)):
        for corner in range(3):
            vertex = triangles[t, corner]
            row = rows.start[t] + level[vertex] - rows.first[t]
            if corner_row[vertex] < 0:
                corner_row[vertex] = row
            else:
                a, b = root_of(parent, row), root_of(parent, corner_row[vertex])
                parent[max(a, b)] = min(a, b)
    for row in range(len(parent)):
        parent[row] = root_of(parent, row)
    for vertex in range(len(corner_row)):
        if corner_row[vertex] >= 0:
            corner_row[vertex] = parent[corner_row[vertex]]
