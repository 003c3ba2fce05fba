"""The triangles around an edge, and their planes."""

from typing import NamedTuple

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.bounding.simplification.half_edges import (
    HalfEdgeSurface,
    following,
    has_three_edges,
    preceding,
    rotated,
    start_of,
)
from amprep.kernels.bounding.simplification.points import Point, cross, dot, minus, part

_FLAT = 1e-14
"""Ratio of twice the area to the squared size below which a triangle has no plane."""

_ROUNDING = 2e-15
"""Error of the volume of a tetrahedron relative to the product of its edges, with reserve."""


class EdgePatch(NamedTuple):
    """Work arrays for the triangles around one edge; planes are relative to the middle of the edge.

    Attributes
    ----------
    triangles
        ``(c,)`` triangles that touch the edge; the two of the edge itself come last.
    ring
        ``(c,)`` half-edges around them, in cyclic order; number i belongs to triangle number i.
    normals, offsets
        ``(c, 3)`` unit normals and ``(c,)`` offsets, with the margin.
    weights
        ``(c,)`` a third of the area of each triangle: times the distance, the volume of a tetrahedron.
    margins
        ``(c,)`` margin of each plane, mm.
    rows, sides
        ``(c, 3)`` and ``(c,)`` normals and offsets in coordinates in which the cost is a distance.
    place
        ``(3,)`` position of the new vertex.
    mark
        ``(n,)`` number of the last patch in which a vertex was adjacent to the start of the edge.
    clock
        ``(1,)`` number of patches so far.
    """

    triangles: Int32s
    ring: Int32s
    normals: Floats
    offsets: Floats
    weights: Floats
    margins: Floats
    rows: Floats
    sides: Floats
    place: Floats
    mark: Int64s
    clock: Int64s


@part
def gather(surface: HalfEdgeSurface, patch: EdgePatch, h: int) -> int:
    """Collect the triangles around an edge and the ring; return their number, 0 if the link condition fails.

    The link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999) keeps the surface a manifold: the ends have two
    common neighbours, which are the tips of the two triangles of the edge, and these have more than three edges.
    """
    start, twin = surface.start, surface.opposite[h]
    if has_three_edges(surface, start[preceding(h)]) or has_three_edges(surface, start[preceding(twin)]):
        return 0
    patch.clock[0] += 1
    count, common = 0, 0
    for side in range(2):
        first, other = (h, twin) if side == 0 else (twin, h)
        g = first
        while True:
            neighbour = start[following(g)]
            if side == 0:
                patch.mark[neighbour] = patch.clock[0]
            elif patch.mark[neighbour] == patch.clock[0]:
                common += 1
            if g != first and g != following(other):
                if count == patch.ring.size - 2:
                    return 0
                patch.triangles[count], patch.ring[count] = g // 3, following(g)
                count += 1
            g = rotated(surface, g)
            if g == first:
                break
    if common != 2:
        return 0
    patch.triangles[count], patch.triangles[count + 1] = h // 3, twin // 3
    return count + 2


@part
def measure(surface: HalfEdgeSurface, patch: EdgePatch, count: int, margin: float, middle: Point) -> int:
    """Compute the planes of the triangles; return the number of those that have one, which come first.

    A degenerate triangle has no plane: its tetrahedron with any point is empty.
    """
    planes = 0
    for i in range(count):
        first = 3 * patch.triangles[i]
        a = start_of(surface, first)
        u, v = minus(start_of(surface, first + 1), a), minus(start_of(surface, first + 2), a)
        n = cross(u, v)
        length, one, two = dot(n, n) ** 0.5, dot(u, u), dot(v, v)
        if length <= _FLAT * (one + two):
            continue
        n = n[0] / length, n[1] / length, n[2] / length
        kept = max(margin, _ROUNDING * max(one, two) ** 1.5 / length)
        patch.normals[planes, 0], patch.normals[planes, 1], patch.normals[planes, 2] = n
        patch.offsets[planes] = dot(n, minus(a, middle)) + kept
        patch.weights[planes], patch.margins[planes] = length / 6.0, kept
        planes += 1
    return planes
