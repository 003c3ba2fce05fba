"""Half-edges of a closed triangle surface: rings around vertices, and the contraction of an edge.

Half-edge ``h = 3 t + k`` starts at corner k of triangle t and ends at the next corner. Its triangle is
on its left, seen from outside. The other half of the same edge belongs to the neighbouring triangle.
"""

from typing import NamedTuple

from amprep.arrays import Floats, Int32s
from amprep.kernels.bounding.simplification.points import Point, inlined, part


class HalfEdgeSurface(NamedTuple):
    """A closed oriented surface; arrays are modified in place.

    Attributes
    ----------
    points
        ``(n, 3)`` mm.
    start
        ``(3 m,)`` vertex at which each half-edge starts; -1 for triangles that are gone.
    opposite
        ``(3 m,)`` other half of each edge.
    leaving
        ``(n,)`` one half-edge that starts at each vertex.
    """

    points: Floats
    start: Int32s
    opposite: Int32s
    leaving: Int32s


@inlined
def following(h: int) -> int:
    """Return the next half-edge of the same triangle."""
    return h - 2 if h % 3 == 2 else h + 1


@inlined
def preceding(h: int) -> int:
    """Return the previous half-edge of the same triangle."""
    return h + 2 if h % 3 == 0 else h - 1


@inlined
def edge_of(surface: HalfEdgeSurface, h: int) -> int:
    """Return the number of the edge: the lower number of its two halves."""
    return int(min(h, surface.opposite[h]))


@inlined
def rotated(surface: HalfEdgeSurface, h: int) -> int:
    """Return the next half-edge that starts at the same vertex, counter-clockwise seen from outside."""
    return int(surface.opposite[preceding(h)])


@inlined
def point_of(surface: HalfEdgeSurface, vertex: int) -> Point:
    """Return the position of a vertex."""
    return surface.points[vertex, 0], surface.points[vertex, 1], surface.points[vertex, 2]


@inlined
def start_of(surface: HalfEdgeSurface, h: int) -> Point:
    """Return the position at which a half-edge starts."""
    return point_of(surface, surface.start[h])


@inlined
def has_three_edges(surface: HalfEdgeSurface, vertex: int) -> bool:
    """Tell whether only three edges end at a vertex."""
    first = surface.leaving[vertex]
    return bool(rotated(surface, rotated(surface, rotated(surface, first))) == first)


@inlined
def _join(surface: HalfEdgeSurface, h: int) -> None:
    """Remove the triangle of a half-edge that is contracted, and join its two other edges to one."""
    start, opposite = surface.start, surface.opposite
    one, other = opposite[following(h)], opposite[preceding(h)]
    opposite[one], opposite[other] = other, one
    surface.leaving[start[one]] = one
    surface.leaving[start[other]] = other
    first = h - h % 3
    for k in range(first, first + 3):
        start[k] = -1


@part
def contract(surface: HalfEdgeSurface, h: int, place: Point) -> int:
    """Contract the edge of half-edge `h` to a vertex at a position; return that vertex.

    The vertex at the start is moved, the one at the end and the two triangles of the edge are removed. The link
    condition must be satisfied.
    """
    start, opposite = surface.start, surface.opposite
    twin = opposite[h]
    kept, gone = start[h], start[twin]
    g = rotated(surface, twin)
    while g != twin:
        start[g] = kept
        g = rotated(surface, g)
    start[twin] = kept
    _join(surface, h)
    _join(surface, twin)
    surface.leaving[gone] = -1
    surface.points[kept, 0], surface.points[kept, 1], surface.points[kept, 2] = place
    return int(kept)
