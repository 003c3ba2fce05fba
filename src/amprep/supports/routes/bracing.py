"""Joins slender columns to their neighbours by oblique struts, so that they do not sway or fall over."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bytes, Ints
from amprep.geometry.voxels.grid import Grid
from amprep.model.support_edges import DIRECTIONS, SupportEdges
from amprep.model.supports import Voxel

FARTHEST_MM = 15.0
"""mm sideways; struts are no longer than this."""

_OBLIQUE = tuple((number, *step) for number, step in enumerate(DIRECTIONS) if step != (0, 0))

Square = tuple[int, int, int]


class Joined(NamedTuple):
    """The struts as edges, and how many slender columns have some, and none."""

    edges: SupportEdges
    braced: int
    alone: int


def join_columns(frame: Grid, voxels: Bytes, edges: SupportEdges, slender: float) -> Joined:
    """Brace every column higher than `slender` times its least width.

    A column is a connected piece of the supports of one part; its width is that of the box around its
    squares. From each height of `slender` widths upwards a strut of oblique edges leads down from the
    column, one square sideways a layer, to the nearest square of another column of the same part: at the
    strut angle, so it carries itself. Struts pass free voxels that no other part's supports use. They carry
    no path: flow 1 and capacity 1 stand for the least section of the cell.
    """
    piece, _ = edges.components(np.empty((0, 3), np.int32))
    squares = np.concatenate([edges.upper, edges.lower])
    pieces, parts = np.concatenate([piece, piece]), np.concatenate([edges.part, edges.part])
    owners = _Owners(squares, pieces, parts, edges.voxel_parts())
    struts: list[list[int]] = []
    braced = alone = 0
    for number in range(int(piece.max(initial=-1)) + 1):
        own = squares[pieces == number]
        count, slim = 0, False
        for square in _levels(own, frame, slender):
            slim = True
            strut = _strut(square, number, owners, voxels, round(FARTHEST_MM / frame.pitch))
            struts += strut
            owners.voxel_part.update(SupportEdges.from_rows(strut).voxel_parts())
            count += bool(strut)
        braced += count > 0
        alone += slim and not count
    return Joined(SupportEdges.from_rows(struts), braced, alone)


class _Owners:
    """Which column and part each square belongs to, and which part's supports use each voxel."""

    def __init__(self, squares: Ints, pieces: Ints, parts: Ints, voxels: dict[Square, int]) -> None:
        names = [(plane, y, x) for plane, y, x in squares.tolist()]
        self.piece: dict[Square, int] = dict(zip(names, pieces.tolist(), strict=True))
        self.part: dict[Square, int] = dict(zip(names, parts.tolist(), strict=True))
        self.voxel_part = voxels


def _levels(own: Ints, frame: Grid, slender: float) -> Iterator[Square]:
    """Yield a square of a column at each height where it should be braced."""
    extent = np.ptp(own[:, 1:], axis=0) + 1
    free = slender * float(extent.min()) * frame.pitch
    top = int(own[:, 0].max())
    for height in np.arange(free, top * frame.step, free):
        at = own[own[:, 0] == int(height / frame.step)]
        if len(at):
            plane, y, x = at[np.lexsort(at.T[::-1])][0].tolist()
            yield plane, y, x


def _strut(start: Square, piece: int, owners: _Owners, voxels: Bytes, farthest: int) -> list[list[int]]:
    """Search downwards, breadth first, for the nearest square of another column of the part; return the edges."""
    part = owners.part[start]
    came: dict[Square, tuple[Square, int]] = {}
    front = [start]
    for _ in range(min(farthest, start[0])):
        following: dict[Square, None] = {}
        for plane, y, x in front:
            for direction, dy, dx in _OBLIQUE:
                after = (plane - 1, y + dy, x + dx)
                if after in came or not _free(voxels, owners, part, (plane - 1, y, x), after):
                    continue
                found = owners.piece.get(after)
                if found == piece:
                    continue
                came[after] = ((plane, y, x), direction)
                if found is not None:
                    return _way(after, start, came, part) if owners.part[after] == part else []
                following[after] = None
        front = list(following)
    return []


def _free(voxels: Bytes, owners: _Owners, part: int, *needed: Square) -> bool:
    """Tell whether an edge may use these voxels."""
    for voxel in needed:
        plane, y, x = voxel
        if not (0 <= plane < voxels.shape[0] and 0 <= y < voxels.shape[1] and 0 <= x < voxels.shape[2]):
            return False
        if voxels[plane, y, x] != Voxel.FREE or owners.voxel_part.get(voxel, part) != part:
            return False
    return True


def _way(end: Square, start: Square, came: dict[Square, tuple[Square, int]], part: int) -> list[list[int]]:
    """Return the edges from `start` down to `end`."""
    edges = []
    here = end
    while here != start:
        here, direction = came[here]
        edges.append([*here, direction, 1, 1, part])
    return edges
