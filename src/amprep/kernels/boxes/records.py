"""Records and array columns that the packing kernels share."""

from typing import NamedTuple, Self

import numpy as np

from amprep.arrays import Floats, Int64s

PAIR_SLACK = 1e-6
"""Overlap (mm) below which two boxes only touch."""

RESIDUAL, LOW, TOUCHING, CENTRE = 0, 1, 2, 3
"""Merits of a placement rule: least residual space; lowest weighted far corner; largest contact area; nearest to
the axis of a cylinder."""

MERIT_OF, WEIGHT, GRID, PHASE = 0, 1, 4, 5
"""Columns of a placement rule: merit; three weights of the far corner; greatest number of line crossings that are
tried; phase.

The phase is a set of bits for round plates: 1 and 2 centre the first item in x and in y; 4 also slides items to the
wall across the rows.
"""

AXIS_X, AXIS_Y, RADIUS, GAP, SLACK, FLAT, LEAST = 6, 7, 8, 9, 10, 11, 12
"""Columns of the room after its two corners: axis of a cylinder; its radius less the clearance (0: a box);
clearance; slack of walls; whether nothing is stacked; three residual spaces. A point with less residual space is
of no use to any item."""


class Arrangement(NamedTuple):
    """Build, orientation and position of every item: the one solution record of all packers and kernels.

    Attributes
    ----------
    build
        ``(n,)`` int64 number of the build; -1 for an item in no build.
    orientation
        ``(n,)`` int64 index into all orientations of the instance; without meaning for an item in no build.
    position
        ``(n, 3)`` mm, least corner of the turned bounding volume.
    """

    build: Int64s
    orientation: Int64s
    position: Floats

    @classmethod
    def unassigned(cls, items: int) -> Self:
        """Return an arrangement of `items` items, all of them in no build."""
        return cls(np.full(items, -1, np.int64), np.zeros(items, np.int64), np.zeros((items, 3)))

    def copy(self) -> Self:
        """Return a copy with its own arrays."""
        return type(self)(self.build.copy(), self.orientation.copy(), self.position.copy())

    @property
    def builds(self) -> int:
        """Number of builds."""
        return int(self.build.max(initial=-1)) + 1


class BoxInstance(NamedTuple):
    """Items of boxes and the room for them.

    Clearance is part of the data: each box is longer by it at its upper sides, and the upper walls and the obstacles
    are moved by it. Boxes that touch here keep the clearance in the build.

    Attributes
    ----------
    type_of
        ``(n,)`` item type of each item. Items of one type share bounding volume and orientations.
    first_orientation
        ``(types + 1,)`` index of the first orientation of each type.
    first_box
        ``(orientations + 1,)`` index of the first box of each orientation.
    orientations
        ``(orientations, 6)`` mm: size of the enclosing box, and a feasible position in an empty build (NaN: none).
    boxes
        ``(boxes, 6)`` mm corners, relative to the least corner of the enclosing box.
    room
        ``(15,)`` mm corners, then the columns from `AXIS_X` on.
    obstacles
        ``(m, 6)`` mm corners of forbidden zones, then of fixed boxes.
    zones
        The first `zones` obstacles are in every build, the others in the first build only.
    """

    type_of: Int64s
    first_orientation: Int64s
    first_box: Int64s
    orientations: Floats
    boxes: Floats
    room: Floats
    obstacles: Floats
    zones: int
