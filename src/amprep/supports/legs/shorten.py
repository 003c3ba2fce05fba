"""Brace legs that are too long for their width, or make them thicker."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports.edges import SupportEdges
from amprep.supports.legs.divide import Division
from amprep.supports.legs.find import RoutedLeg, find_legs
from amprep.supports.legs.room import OpenVoxels, Room
from amprep.supports.legs.sections import Sections, find_sections
from amprep.supports.legs.thicken import thicken

LONGEST_STRUT = 15.0
"""Largest horizontal length of a strut, mm."""

TOUCHING = 0.75
"""Length (widths, at a strut angle of 45 degrees) along which a strut touches a leg without dividing it."""

ROUNDS = 8
"""Largest number of rounds; the columns of one round can be legs that the next one divides."""


class LegRules(NamedTuple):
    """What legs are measured by.

    Attributes
    ----------
    ratio
        Largest ratio of length to width of a leg.
    cell
        Extents (mm) of one cell, see `amprep.supports.legs.cell.measure_cell`.
    """

    ratio: float
    cell: Floats


class LongLeg(NamedTuple):
    """A leg that stays too long for its width: its ratio, and the middle of it in mm."""

    ratio: float
    position_mm: tuple[float, float, float]


class ShortenedLegs(NamedTuple):
    """What makes legs short enough.

    Attributes
    ----------
    edges
        The edges of struts, further columns and thicker feet.
    divided, thickened
        Numbers of legs that struts or further columns divide, and that are wider in their lower part.
    left
        The legs that stay too long.
    """

    edges: SupportEdges
    divided: int
    thickened: int
    left: tuple[LongLeg, ...]


def shorten_legs(
    grid: Grid, edges: SupportEdges, held: Ints, rules: LegRules, opened: Callable[[int], OpenVoxels]
) -> ShortenedLegs:
    """Divide or thicken every leg whose ratio of length to width is too large.

    Strategy: a leg is a chain of sections, so it is known where it must be divided: the lowest stretch may reach
    as far up as its width allows, and the division should be near that, so that few are needed. A strut leads
    from there, at the strut angle, down or up to another support of the same part, and divides both. A further
    column to the plate, two squares away, does the same where that is cheaper, or where no support is near. Where
    there is no room for either, columns that touch the leg make its lower part wider, in proportion to the length
    above. All of that changes the legs, so they are found again, until none is too long or nothing helps. A round
    takes time in proportion to the squares in use and to the candidates for struts.

    Parameters
    ----------
    grid
        The support grid.
    edges
        The edges of all supports, each with its part.
    held
        ``(h, 3)`` squares that a part holds, or that stand on one.
    rules
        Largest ratio, and extents of one cell.
    opened
        Returns the voxels that the supports of a part may use.
    """
    ratio, touching = rules.ratio, TOUCHING * grid.step / grid.pitch
    longest = longest_strut(grid, ratio * float(rules.cell.min()))
    rows: list[list[int]] = []
    divided = thickened = 0
    whole = edges
    for _ in range(ROUNDS):
        sections = find_sections(grid, whole, held, rules.cell)
        legs = too_long(sections, ratio, touching)
        room = Room(sections, whole, opened)
        division = Division(room, legs, ratio, longest)
        for number, leg in enumerate(legs):
            before = len(room.rows)
            if not division.divide(number) and len(room.rows) == before:
                for column in thicken(room, leg, ratio, grid.pitch, rules.cell):
                    room.add(column, room.part[column.squares[0]])
                thickened += len(room.rows) > before
            else:
                divided += 1
        if not room.rows:
            break
        rows += room.rows
        whole = SupportEdges.concatenate([edges, SupportEdges.from_rows(rows)]).merged()
    sections = find_sections(grid, whole, held, rules.cell)
    left = tuple(long_leg(leg, sections, grid) for leg in too_long(sections, ratio, 0.0))
    return ShortenedLegs(SupportEdges.from_rows(rows), divided, thickened, left)


def longest_strut(grid: Grid, longest_leg: float) -> int:
    """Return the largest number of layers of a strut, which must not be too long a leg itself."""
    return max(1, min(int(LONGEST_STRUT / grid.pitch), int(longest_leg / np.hypot(grid.pitch, grid.step))))


def too_long(sections: Sections, ratio: float, touching: float) -> list[RoutedLeg]:
    """Return the legs with a larger ratio, the longest first."""
    legs = [leg for leg in find_legs(sections, touching) if leg.ratio() > ratio]
    return sorted(legs, key=lambda leg: (-sum(leg.lengths), leg.sections))


def long_leg(leg: RoutedLeg, sections: Sections, grid: Grid) -> LongLeg:
    """Return the ratio and the middle of a leg."""
    middle = leg.sections[len(leg.sections) // 2]
    plane, y, x = sections.square[sections.section == middle].mean(axis=0).tolist()
    place = grid.origin + np.array([(x + 0.5) * grid.pitch, (y + 0.5) * grid.pitch, plane * grid.step])
    return LongLeg(leg.ratio(), (float(place[0]), float(place[1]), float(place[2])))
