"""Convex pieces of polygons with holes."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats

# Strategy. A triangulation, from which edges inside are removed, the longest first, while the two pieces beside the
# edge form a convex one (Hertel, Mehlhorn 1983, doi:10.1007/3-540-12689-9_105): at most four times as many pieces as
# necessary, and exact.

Piece = list[int]

STRAIGHT = 1e-9
"""Cross product (mm2) at a corner that counts as straight."""


def convex_pieces(loops: Sequence[Floats]) -> list[Floats]:
    """Return convex polygons ``(k, 2)``, counter-clockwise, whose union is the inside of polygons.

    Parameters
    ----------
    loops
        ``(k, 2)`` mm, disjoint polygons with the inside to their left, counter-clockwise, and holes clockwise.
    """
    from manifold3d import triangulate

    points = np.concatenate(loops)
    pieces: dict[int, Piece] = dict(enumerate(triangulate(list(loops), -1.0, False).tolist()))
    beside: dict[tuple[int, int], int] = {}
    for number, piece in pieces.items():
        for edge in _edges(piece):
            beside[edge] = number
    inner = [(a, b) for a, b in beside if a < b and (b, a) in beside]
    inner.sort(key=lambda edge: (-float(np.hypot(*(points[edge[0]] - points[edge[1]]))), edge))
    flat = points.tolist()
    for edge in inner:
        _join(pieces, beside, flat, edge)
    return [points[_without_straight(piece, flat)] for piece in pieces.values()]


def _edges(piece: Piece) -> list[tuple[int, int]]:
    return list(zip(piece, piece[1:] + piece[:1], strict=True))


def _join(
    pieces: dict[int, Piece],
    beside: dict[tuple[int, int], int],
    points: list[list[float]],
    edge: tuple[int, int],
) -> None:
    """Join the pieces on both sides of an edge if they are convex together."""
    one, other = beside[edge], beside[edge[::-1]]
    if one == other:
        return
    a, b = edge
    first, second = _from(pieces[one], b), _from(pieces[other], a)
    if not (_turns_left(points, first[-2], a, second[1]) and _turns_left(points, second[-2], b, first[1])):
        return
    joined = first[:-1] + second[:-1]  # b ... (before a), a ... (before b)
    pieces[one] = joined
    for each in _edges(pieces.pop(other)):
        beside[each] = one
    del beside[edge], beside[edge[::-1]]


def _from(piece: Piece, corner: int) -> Piece:
    """Return a piece that begins at a corner."""
    k = piece.index(corner)
    return piece[k:] + piece[:k]


def _turns_left(points: list[list[float]], a: int, b: int, c: int) -> bool:
    (ax, ay), (bx, by), (cx, cy) = points[a], points[b], points[c]
    return (bx - ax) * (cy - by) - (by - ay) * (cx - bx) >= -STRAIGHT


def _without_straight(piece: Piece, points: list[list[float]]) -> Piece:
    """Return a piece without corners on a straight line, as long as a triangle is left."""
    corners = list(piece)
    k = 0
    while len(corners) > 3 and k < len(corners):
        a, b, c = corners[k - 1], corners[k], corners[(k + 1) % len(corners)]
        (ax, ay), (bx, by), (cx, cy) = points[a], points[b], points[c]
        if abs((bx - ax) * (cy - by) - (by - ay) * (cx - bx)) <= STRAIGHT:
            corners.pop(k)
        else:
            k += 1
    return corners
