"""Records that the kernels of G-code share: the machine, the tracks of objects, and known lines."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bytes, Floats, Int64s

X, Y, Z, E = 0, 1, 2, 3
"""Indices of axes, in positions and in words."""
I, J, R = 4, 5, 6  # noqa: E741 - the letters of G-code
"""Indices of the words of arcs."""
UNIT, HALF_WIDTH, HEIGHT, LOWER = 7, 8, 9, 10
"""Indices in `Machine.at`: length of a unit, half the width of lines, height of the last line, height before that."""
RELATIVE, RELATIVE_E, SLOT, ROLE, SEGMENTS = 0, 1, 2, 3, 4
"""Indices in `Machine.modes`."""

OUTER_WALL, WALL, INFILL, UNKNOWN, SUPPORT, ADHESION, OTHER = 0, 1, 2, 3, 4, 5, 6
"""Roles of extrusions; those up to `UNKNOWN` belong to the object."""
ROLES = 7

NOTHING, OBJECT, FEATURE = 0, 1, 2
"""What a known line does: nothing, it changes the object, it changes the role."""

MORE, FULL, UNKNOWN_LINE = 0, 1, 2
"""Why reading stopped: for more text, for room for segments, at a line that the caller must explain."""

MOST_CHORDS = 720
"""Most chords of an arc."""
COLUMNS = 9
"""Columns of segments: row, z and thickness of the layer, start x and y, end x and y, half the width, and
whether it is an outer wall."""


class Machine(NamedTuple):
    """The state of a printer; kernels modify it.

    Attributes
    ----------
    at
        ``(11,)`` mm: position x, y, z and e, offsets of x, y and z by G92, and what `UNIT` to `LOWER` name.
    words
        ``(7,)`` values of the words of the present line.
    modes
        ``(5,)`` whether axes are relative, whether E is relative, slot of the present object (0 for none), role,
        and number of segments recorded.
    """

    at: Floats
    words: Floats
    modes: Int64s


class Tracks(NamedTuple):
    """What was extruded; kernels modify it.

    Slot s has two rows: ``2 s`` for the object itself, ``2 s + 1`` for supports that the slicer printed with it.

    Attributes
    ----------
    extent
        ``(rows, 6)`` mm, least and greatest x, y, z of the lines, with half their widths.
    length
        ``(rows, ROLES)`` mm of lines in each role; skirts and the like count in the first row of their slot.
    layer
        ``(rows, 3)`` mm: z of the highest layer, its thickness, and the greatest thickness above the first layer.
    counts
        ``(rows, 3)`` number of layers, next of the heights to be recorded, and whether the present layer is recorded.
    heights
        ``(k,)`` mm, ascending: the layer in which each lies is recorded.
    """

    extent: Floats
    length: Floats
    layer: Floats
    counts: Int64s
    heights: Floats


class KnownLines(NamedTuple):
    """A hash table of lines by their text, with open addressing.

    Attributes
    ----------
    key
        ``(2^n,)`` uint64 hashes, 0 for an empty place.
    kind, value
        ``(2^n,)`` what the line does, and the slot or role.
    prefix
        ``(p, w)`` uint8, beginnings of the lines that the table concerns, padded with zeros.
    width_prefix
        ``(q, w)`` uint8, beginnings of the lines that state the width of lines.
    """

    key: NDArray[np.uint64]
    kind: Int64s
    value: Int64s
    prefix: Bytes
    width_prefix: Bytes
