"""Make the lower part of a leg wider by columns that touch it."""

from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.model.supports.edges import DIRECTIONS, Square
from amprep.supports.legs.find import RoutedLeg
from amprep.supports.legs.room import Room, Strut
from amprep.supports.legs.sections import PLANES_TO_TOUCH, directions

LARGEST_WIDTH = 5
"""Largest width (squares) to which a leg is thickened."""

_QUADRANTS = ((1, 1), (1, -1), (-1, 1), (-1, -1))


def thicken(room: Room, leg: RoutedLeg, ratio: float, pitch: float, cell: Floats) -> list[Strut]:
    """Return columns with which no stretch of a leg is too long, none if there is no room for them.

    Each column is a copy of a path down the leg, shifted along x or y. Two columns, one square away along both
    axes, make the leg two squares wide; two further ones make it three squares wide, and so on. Columns
    begin where the width above is not enough any more. They end at the plate, or join the leg again as low as they can.

    Parameters
    ----------
    room
        What is in use and what may be used.
    leg
        The leg.
    ratio
        Largest ratio of length to width.
    pitch
        Horizontal size (mm) of a voxel.
    cell
        Extents (mm) of one cell, see `amprep.supports.legs.cell.measure_cell`.
    """
    path, leg = _path(room, leg), replace(leg, touching=0.0)
    if path is None or leg.ratio() <= ratio:
        return []
    for along_y, along_x in _QUADRANTS:
        columns = _columns(room, leg, path, (along_y, along_x), ratio, pitch, cell)
        if columns:
            return columns
    return []


def _path(room: Room, leg: RoutedLeg) -> list[Square] | None:
    """Return squares from the lower to the upper end of a leg, one in each section, each connected to the next."""
    for start in room.squares[leg.sections[-1]]:
        path = [start]
        for section in leg.sections[-2::-1]:
            plane, y, x = path[-1]
            below = ((plane - 1, y + dy, x + dx) for dy, dx in DIRECTIONS)
            after = next((each for each in below if room.section.get(each) == section), None)
            if after is None:
                break
            path.append(after)
        if len(path) == len(leg.sections):
            return path[::-1]
    return None


def _columns(
    room: Room,
    leg: RoutedLeg,
    path: list[Square],
    quadrant: tuple[int, int],
    ratio: float,
    pitch: float,
    cell: Floats,
) -> list[Strut]:
    """Return the columns in one quadrant beside a leg, none if voxels are not free or the width does not suffice."""
    columns: list[Strut] = []
    highest = {step: len(path) - 1 for step in ((quadrant[0], 0), (0, quadrant[1]))}
    own = [list(room.squares[section]) for section in leg.sections]
    for shift in range(1, LARGEST_WIDTH):
        lowest = _lowest_enough(leg, ratio)
        for step in tuple(highest):
            in_leg = {square for squares in own for square in squares}
            if {_shifted(each, step, shift) for each in path[1:-1]} <= in_leg:
                continue
            found = _column(room, path, step, shift, range(lowest, highest[step]))
            if found is None:
                return []
            column, begin = found
            highest[step] = begin
            columns.append(column)
            for k, square in enumerate(column.squares[1:]):
                own[begin - k].append(square)
        widths = tuple(_width(squares, pitch, cell) for squares in own)
        leg = replace(leg, widths=widths)
        if leg.ratio() <= ratio:
            return columns
    return []


def _column(
    room: Room, path: list[Square], step: tuple[int, int], shift: int, begins: range
) -> tuple[Strut, int] | None:
    """Return an open column beside a path that leads as far down as possible, and the position of its first square.

    It begins as low as possible in the range `begins`, where the path leads straight down, and it is long enough to
    touch the leg.
    """
    for end in range(len(path) - PLANES_TO_TOUCH):
        if path[end][0] > 0 and path[end][1:] != path[end + 1][1:]:
            continue
        low_enough = range(max(begins.start, end + PLANES_TO_TOUCH), begins.stop)
        begin = next((k for k in low_enough if path[k][1:] == path[k + 1][1:]), None)
        if begin is None:
            return None
        squares = [_shifted(path[begin + 1], step, shift - 1)]
        squares += [_shifted(path[k], step, shift) for k in range(begin, end, -1)]
        squares.append(_shifted(path[end], step, shift if path[end][0] == 0 else shift - 1))
        in_use = any(each in room.section for each in squares[1:-1])
        if not in_use and room.is_open(squares, room.part[path[-1]]):
            return Strut(tuple(squares)), begin
    return None


def _lowest_enough(leg: RoutedLeg, ratio: float) -> int:
    """Return the lowest position down to which a leg is wide enough."""
    last = len(leg.lengths)
    lowest = last - 1
    while lowest > 0 and leg.ratio(lowest - 1, last) <= ratio:
        lowest -= 1
    return lowest


def _shifted(square: Square, step: tuple[int, int], count: int) -> Square:
    return square[0], square[1] + count * step[0], square[2] + count * step[1]


def _width(squares: list[Square], pitch: float, cell: Floats) -> float:
    """Return the least width (mm) of the hull of squares of one plane."""
    along = np.array(squares)[:, :0:-1] @ directions().T
    return float((np.ptp(along, axis=0) * pitch + cell).min())
