"""The squares and voxels that supports use, and those that further struts may use."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Bytes
from amprep.model.supports import Voxel
from amprep.model.supports.edges import DIRECTIONS, Square, SupportEdges
from amprep.supports.legs.sections import Sections

DIRECTION_OF = {step: number for number, step in enumerate(DIRECTIONS)}
"""Number of each direction ``(dy, dx)``."""


class Strut(NamedTuple):
    """Squares from the upper to the lower end of a strut, each one layer below the one before."""

    squares: tuple[Square, ...]

    @property
    def cost(self) -> int:
        """Number of edges."""
        return len(self.squares) - 1

    def rows(self, part: int) -> list[list[int]]:
        """Return the rows of the edges, as `SupportEdges.from_rows` reads them."""
        pairs = zip(self.squares, self.squares[1:], strict=False)
        return [
            [*upper, DIRECTION_OF[lower[1] - upper[1], lower[2] - upper[2]], 1, 1, part]
            for upper, lower in pairs
        ]


class OpenVoxels(NamedTuple):
    """The voxels that the supports of one part may use if they are free.

    Attributes
    ----------
    voxels
        ``(nz, ny, nx)`` uint8, values of `Voxel`, of the whole grid.
    first
        Row and column of the first column of voxels in `opened`.
    opened
        ``(nz, ny, nx)`` bool, the open voxels; voxels beside them are closed. None if all are open.
    """

    voxels: Bytes
    first: tuple[int, int] = (0, 0)
    opened: Bools | None = None

    def open_block(self) -> Bools:
        """Return whether each voxel of the block that begins at `first` is free and open."""
        if self.opened is None:
            return np.asarray(self.voxels == Voxel.FREE)
        _, ny, nx = self.opened.shape
        y, x = self.first
        block = self.voxels[: len(self.opened), y : y + ny, x : x + nx]
        return np.asarray((block == Voxel.FREE) & self.opened)


class _Block(NamedTuple):
    """The first row and column of a block of voxels, its shape, and 1 for those that are open.

    Items of a `memoryview` are read faster than those of an array.
    """

    first: tuple[int, int]
    shape: tuple[int, ...]
    opened: memoryview


class Room:
    """What the supports use, and what they may use in addition.

    Parameters
    ----------
    sections
        The sections of the supports.
    edges
        The edges of the supports.
    opened
        Returns the voxels that the supports of a part may use.
    """

    def __init__(self, sections: Sections, edges: SupportEdges, opened: Callable[[int], OpenVoxels]) -> None:
        names: list[Square] = [(plane, y, x) for plane, y, x in sections.square.tolist()]
        self.section = dict(zip(names, sections.section.tolist(), strict=True))
        self.part = dict(zip(names, sections.part.tolist(), strict=True))
        self.squares: list[list[Square]] = [[] for _ in sections.width]
        for name, section in self.section.items():
            self.squares[section].append(name)
        self._user = edges.voxel_parts()
        self._opened, self._blocks = opened, dict[int, _Block]()
        self.rows: list[list[int]] = []

    def is_open(self, squares: Sequence[Square], part: int) -> bool:
        """Tell whether edges between squares keep to voxels that are free and not used by another part's supports."""
        if part not in self._blocks:
            self._blocks[part] = _block_of(self._opened(part))
        (first_y, first_x), (nz, ny, nx), block = self._blocks[part]
        user = self._user
        for (_, y, x), (below, after_y, after_x) in zip(squares, squares[1:], strict=False):
            if not 0 <= below < nz:
                return False
            for at_y, at_x in ((y, x), (after_y, after_x)):
                row, column = at_y - first_y, at_x - first_x
                if not (0 <= row < ny and 0 <= column < nx and block[below, row, column]):
                    return False
                if user.get((below, at_y, at_x), part) != part:
                    return False
        return True

    def add(self, strut: Strut, part: int) -> None:
        """Add a strut; other struts go round its squares."""
        self.rows += strut.rows(part)
        for (_, y, x), (below, after_y, after_x) in zip(strut.squares, strut.squares[1:], strict=False):
            self._user[below, y, x] = self._user[below, after_y, after_x] = part
        for square in strut.squares:
            self.section.setdefault(square, -1)
            self.part.setdefault(square, part)


def _block_of(opened: OpenVoxels) -> _Block:
    block = np.ascontiguousarray(opened.open_block(), np.uint8)
    return _Block(opened.first, block.shape, block.data)
