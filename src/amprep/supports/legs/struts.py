"""Search for struts from a leg to other supports of the same part, and for further columns to the plate."""

from collections.abc import Iterator, Sequence
from functools import cache

from amprep.model.supports.edges import Square
from amprep.supports.legs.room import Room, Strut

PROP_DISTANCES = (2, 3, 4)
"""Squares from a leg to a further column beside it; with one square between them, their cells do not touch."""


@cache
def offsets(distance: int) -> tuple[tuple[int, int], ...]:
    """Return the offsets ``(dy, dx)`` at a distance of so many steps."""
    return tuple(
        (dy, dx)
        for dy in range(-distance, distance + 1)
        for dx in sorted({distance - abs(dy), abs(dy) - distance})
    )


@cache
def ways(dy: int, dx: int) -> tuple[tuple[tuple[int, int], ...], ...]:
    """Return three ways over an offset, as sequences of steps: along x first, along y first, and in turns."""
    sign_y, sign_x = (1 if dy > 0 else -1, 0), (0, 1 if dx > 0 else -1)
    along_y, along_x = [sign_y] * abs(dy), [sign_x] * abs(dx)
    in_turns: list[tuple[int, int]] = []
    y, x = list(along_y), list(along_x)
    while y or x:
        source = y if len(y) * max(abs(dx), 1) >= len(x) * max(abs(dy), 1) and y else x or y
        in_turns.append(source.pop())
    return tuple(dict.fromkeys((tuple(in_turns), tuple(along_x + along_y), tuple(along_y + along_x))))


def struts_between(
    room: Room, start: Square, longest: int, leg: tuple[int, ...]
) -> Iterator[tuple[Strut, int]]:
    """Yield open struts between a square of a leg and squares of other sections of the part, the shortest first.

    A strut leads one square sideways in each layer, downwards or upwards from the leg. It may lead to an end of the
    leg, but not to a section there that the leg already meets in the next layer. Columns that touch at a corner are
    one slender leg together, so no strut leads from one to the other.

    Parameters
    ----------
    room
        What is in use and what may be used.
    start
        Square of the leg.
    longest
        Largest number of layers of a strut.
    leg
        The sections of the leg.

    Yields
    ------
    The strut and the section at its other end.
    """
    plane, y, x = start
    part = room.part[start]
    for distance in range(1, longest + 1):
        excluded = leg if distance == 1 else leg[1:-1]
        for dy, dx in offsets(distance):
            if distance == 2 and abs(dy) == abs(dx):
                continue
            for end in ((plane - distance, y + dy, x + dx), (plane + distance, y + dy, x + dx)):
                section = room.section.get(end, -1)
                if section < 0 or section in excluded or room.part[end] != part:
                    continue
                upper, lower = (start, end) if end[0] < plane else (end, start)
                strut = _way_between(room, upper, lower, part)
                if strut is not None:
                    yield strut, section


def _way_between(room: Room, upper: Square, lower: Square, part: int) -> Strut | None:
    """Return an open strut between two squares that passes no square in use."""
    for way in ways(lower[1] - upper[1], lower[2] - upper[2]):
        squares = _squares(upper, way)
        if not any(each in room.section for each in squares[1:-1]) and room.is_open(squares, part):
            return Strut(tuple(squares))
    return None


def props_from(room: Room, start: Square, excluded: frozenset[int]) -> Iterator[Strut]:
    """Yield further columns that lead from a square of a leg to the plate, or to supports of the part below.

    Parameters
    ----------
    room
        What is in use and what may be used.
    start
        Square of the leg.
    excluded
        The sections that it must not lead to.
    """
    part = room.part[start]
    for distance in PROP_DISTANCES:
        for dy, dx in offsets(min(distance, start[0])):
            if max(abs(dy), abs(dx)) < PROP_DISTANCES[0]:
                continue
            for way in ways(dy, dx):
                strut = _down(room, _squares(start, way), part, excluded)
                if strut is not None:
                    yield strut
                    break


def _down(room: Room, squares: list[Square], part: int, excluded: frozenset[int]) -> Strut | None:
    """Return a strut continued straight down to the plate or the first square in use; None if it is blocked."""
    if any(each in room.section for each in squares[1:]):
        return None
    plane, y, x = squares[-1]
    while plane > 0:
        plane -= 1
        squares.append((plane, y, x))
        section = room.section.get((plane, y, x))
        if section is not None:
            if section < 0 or section in excluded or room.part[plane, y, x] != part:
                return None
            break
    return Strut(tuple(squares)) if room.is_open(squares, part) else None


def _squares(start: Square, way: Sequence[tuple[int, int]]) -> list[Square]:
    """Return the squares on a way downwards from `start`, one layer a step."""
    squares = [start]
    for dy, dx in way:
        plane, y, x = squares[-1]
        squares.append((plane - 1, y + dy, x + dx))
    return squares
