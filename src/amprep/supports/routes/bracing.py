"""Connect slender columns to their neighbours by oblique struts (cross-bracing), so that they do not sway or fall."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bytes, Ints
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports import Voxel
from amprep.model.supports.edges import DIRECTIONS, SupportEdges

LONGEST_STRUT = 15.0
"""Largest horizontal length of a strut, mm."""

_OBLIQUE = tuple((number, *step) for number, step in enumerate(DIRECTIONS) if step != (0, 0))

Square = tuple[int, int, int]


class Bracing(NamedTuple):
    """The edges of the struts, and the numbers of slender columns with and without a strut."""

    edges: SupportEdges
    braced: int
    alone: int


def add_cross_bracing(grid: Grid, voxels: Bytes, edges: SupportEdges, slenderness_ratio: float) -> Bracing:
    """Brace every column whose slenderness ratio is too large.

    A column is a connected component of the supports of one part; its width is the smaller side of the bounding
    box around its squares. The height ``slenderness_ratio * width`` divides a column into sections. At the top of
    each section a strut of oblique edges leads down, one square sideways a layer, to the nearest square of
    another column of the same part. It has the strut angle, so it needs no support itself. Struts use free voxels
    that no other part's supports use. They carry no path: with flow 1 and capacity 1 they get the smallest section
    of the cell.

    Parameters
    ----------
    grid
        The support grid.
    voxels
        ``(nz, ny, nx)`` uint8, values of `Voxel`.
    edges
        The edges of all supports, each with its part.
    slenderness_ratio
        Height divided by width above which a column is braced.
    """
    of_edge, _ = edges.components(np.empty((0, 3), np.int32))
    squares = np.concatenate([edges.upper, edges.lower])
    column = np.concatenate([of_edge, of_edge])
    owners = _Owners(squares, column, np.concatenate([edges.part, edges.part]), edges.voxel_parts())
    longest = round(LONGEST_STRUT / grid.pitch)
    rows: list[list[int]] = []
    braced = alone = 0
    for number in range(int(of_edge.max(initial=-1)) + 1):
        starts = list(_section_tops(squares[column == number], grid, slenderness_ratio))
        count = 0
        for start in starts:
            strut = _find_strut(start, number, owners, voxels, longest)
            rows += strut
            owners.voxel_part.update(SupportEdges.from_rows(strut).voxel_parts())
            count += bool(strut)
        braced += count > 0
        alone += len(starts) > 0 and not count
    return Bracing(SupportEdges.from_rows(rows), braced, alone)


class _Owners:
    """The column and part that each square belongs to, and the part whose supports use each voxel."""

    def __init__(self, squares: Ints, columns: Ints, parts: Ints, voxels: dict[Square, int]) -> None:
        names = [(plane, y, x) for plane, y, x in squares.tolist()]
        self.column: dict[Square, int] = dict(zip(names, columns.tolist(), strict=True))
        self.part: dict[Square, int] = dict(zip(names, parts.tolist(), strict=True))
        self.voxel_part = voxels


def _section_tops(own: Ints, grid: Grid, slenderness_ratio: float) -> Iterator[Square]:
    """Yield one square of a column ``(n, 3)`` at the top of each of its sections."""
    extent = np.ptp(own[:, 1:], axis=0) + 1
    section = slenderness_ratio * float(extent.min()) * grid.pitch
    top = int(own[:, 0].max())
    for height in np.arange(section, top * grid.step, section):
        at = own[own[:, 0] == int(height / grid.step)]
        if len(at):
            plane, y, x = at[np.lexsort(at.T[::-1])][0].tolist()
            yield plane, y, x


def _find_strut(start: Square, column: int, owners: _Owners, voxels: Bytes, longest: int) -> list[list[int]]:
    """Search downwards, breadth first, for a square of another column of the part; return the rows of the edges.

    The result is empty if there is no such square within `longest` layers, or if the first square found belongs
    to another part.
    """
    part = owners.part[start]
    previous: dict[Square, tuple[Square, int]] = {}
    front = [start]
    for _ in range(min(longest, start[0])):
        following: dict[Square, None] = {}
        for plane, y, x in front:
            for direction, dy, dx in _OBLIQUE:
                after = (plane - 1, y + dy, x + dx)
                if after in previous or not _are_free(voxels, owners, part, (plane - 1, y, x), after):
                    continue
                found = owners.column.get(after)
                if found == column:
                    continue
                previous[after] = ((plane, y, x), direction)
                if found is not None:
                    return _rows_to(after, start, previous, part) if owners.part[after] == part else []
                following[after] = None
        front = list(following)
    return []


def _are_free(voxels: Bytes, owners: _Owners, part: int, *needed: Square) -> bool:
    """Tell whether voxels are inside the grid, free, and not used by the supports of another part."""
    return all(
        min(voxel) >= 0
        and all(at < count for at, count in zip(voxel, voxels.shape, strict=True))
        and voxels[voxel] == Voxel.FREE
        and owners.voxel_part.get(voxel, part) == part
        for voxel in needed
    )


def _rows_to(
    end: Square, start: Square, previous: dict[Square, tuple[Square, int]], part: int
) -> list[list[int]]:
    """Return the rows of the edges from `start` down to `end`."""
    rows = []
    here = end
    while here != start:
        here, direction = previous[here]
        rows.append([*here, direction, 1, 1, part])
    return rows
