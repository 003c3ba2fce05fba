"""Replace triangles of a mesh by finer pieces, and split their neighbours where sides were divided."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Int64s


class Stitched(NamedTuple):
    """Triangles of a mesh in which some are replaced.

    Attributes
    ----------
    triangles, parent
        ``(k, 3)``, and the triangle ``(k,)`` of the original mesh that each is part of.
    piece
        ``(k,)`` index of the piece, or -1 for triangles that are none.
    """

    triangles: Int64s
    parent: Int64s
    piece: Int64s


def stitch(triangles: Int64s, pieces: Int64s, parent: Int64s, first_new: int) -> Stitched:
    """Return a mesh with some triangles replaced by pieces, without T-junctions.

    Parameters
    ----------
    triangles
        ``(m, 3)`` the original mesh.
    pieces, parent
        ``(k, 3)`` triangles, and the original triangle ``(k,)`` that each is part of. Together they cover their
        parents.
    first_new
        Points from this index on are new.
    """
    replaced = np.zeros(len(triangles), np.bool_)
    replaced[parent] = True
    chains = _chains(pieces, first_new)
    kept, split, owner = ~replaced, list[tuple[int, int, int]](), list[int]()
    for face in np.flatnonzero(kept & _touches(triangles, chains)).tolist():
        found = list(_split(triangles[face].tolist(), chains))
        kept[face] = len(found) == 0
        split += found
        owner += [face] * len(found)
    rest = np.flatnonzero(kept)
    return Stitched(
        np.concatenate([triangles[rest], np.array(split, np.int64).reshape(-1, 3), pieces]),
        np.concatenate([rest, np.array(owner, np.int64), parent]),
        np.concatenate([np.full(len(rest) + len(owner), -1), np.arange(len(pieces))]),
    )


def _chains(pieces: Int64s, first_new: int) -> dict[tuple[int, int], list[int]]:
    """Return the new points along each divided side at the border of the pieces, by its ends in both directions."""
    start, end = pieces.ravel(), np.roll(pieces, -1, axis=1).ravel()
    size = int(pieces.max(initial=0)) + 1
    border = ~np.isin(start * size + end, end * size + start)
    onward = {
        a: b for a, b in zip(start[border].tolist(), end[border].tolist(), strict=True) if a >= first_new
    }
    chains: dict[tuple[int, int], list[int]] = {}
    for a, b in zip(start[border].tolist(), end[border].tolist(), strict=True):
        if a < first_new <= b:
            points = [b]
            while points[-1] in onward:
                points.append(onward[points[-1]])
            last = points.pop()
            chains[a, last], chains[last, a] = points, points[::-1]
    return chains


def _touches(triangles: Int64s, chains: dict[tuple[int, int], list[int]]) -> np.ndarray:
    """Tell which triangles have the ends of a divided side among their corners."""
    ends = np.array([each for pair in chains for each in pair], np.int64)
    return np.asarray(np.isin(triangles, ends).sum(axis=1) >= 2)


def _split(corners: list[int], chains: dict[tuple[int, int], list[int]]) -> Iterator[tuple[int, int, int]]:
    """Yield the triangles into which divided sides split a triangle; none if no side is divided."""
    for turn in range(3):
        a, b, c = corners[turn:] + corners[:turn]
        if (a, b) in chains:
            points = [a, *chains[a, b], b]
            inner = list(zip(points[1:-2], points[2:-1], strict=True))
            yield from ((p, q, c) for p, q in inner)
            yield from _fan([c, *chains.get((c, a), []), a], points[1])
            yield from _fan([b, *chains.get((b, c), []), c], points[-2])
            return


def _fan(line: list[int], apex: int) -> Iterator[tuple[int, int, int]]:
    """Yield the triangles from consecutive points of a line to a point."""
    yield from ((p, q, apex) for p, q in zip(line[:-1], line[1:], strict=True))
