"""Divide legs by struts to other supports of the part, or by further columns beside them."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import NamedTuple

from amprep.supports.legs.find import RoutedLeg
from amprep.supports.legs.room import Room, Strut
from amprep.supports.legs.struts import props_from, struts_between

_ENOUGH = 2
"""Struts that are compared at each section."""


class _Choice(NamedTuple):
    """A strut or column that divides a leg.

    Attributes
    ----------
    cost
        Number of its edges for each section by which it divides the leg higher up than before.
    position
        Position of the section in the leg.
    other
        The section at its other end, -1 for the plate.
    """

    cost: float
    position: int
    strut: Strut
    other: int


class Division:
    """Divides the legs of one round; a strut between two legs divides both.

    Parameters
    ----------
    room
        What is in use and what may be used.
    legs
        The legs that are too long for their width.
    ratio
        Largest ratio of length to width.
    longest
        Largest number of layers of a strut.
    """

    def __init__(self, room: Room, legs: Sequence[RoutedLeg], ratio: float, longest: int) -> None:
        self.room, self.legs, self.ratio, self.longest = room, legs, ratio, longest
        self._at = {
            section: (number, position)
            for number, leg in enumerate(legs)
            for position, section in enumerate(leg.sections[1:-1], 1)
        }
        self._ends: list[set[int]] = [{0, len(leg.lengths)} for leg in legs]

    def divide(self, number: int) -> bool:
        """Divide a leg from its lower end upwards until no stretch is too long; tell whether that succeeded."""
        leg = self.legs[number]
        while True:
            ends = sorted(self._ends[number])
            stretch = next((s for s in zip(ends, ends[1:], strict=False) if leg.ratio(*s) > self.ratio), None)
            if stretch is None:
                return True
            choice = self._choose(leg, *stretch)
            if choice is None:
                return False
            self.room.add(choice.strut, self.room.part[choice.strut.squares[0]])
            self._ends[number].add(choice.position)
            if choice.other in self._at:
                other, position = self._at[choice.other]
                self._ends[other].add(position)

    def _choose(self, leg: RoutedLeg, first: int, last: int) -> _Choice | None:
        """Return the cheapest strut or column that divides the stretch between two sections of a leg."""
        highest = max(
            k for k in range(first + 1, last) if k == first + 1 or leg.ratio(first, k) <= self.ratio
        )
        middle = (first + highest + 1) // 2
        for positions in (range(highest, middle - 1, -1), range(middle - 1, first, -1)):
            choices = [each for position in positions for each in self._struts(leg, first, position)]
            columns = (each for position in positions for each in self._columns(leg, first, position))
            choices += islice(columns, 1)
            if choices:
                return min(choices, key=lambda each: (each.cost, -each.position, each.strut.squares))
        return None

    def _struts(self, leg: RoutedLeg, first: int, position: int) -> Iterator[_Choice]:
        """Yield the shortest struts that divide a leg at one of its sections."""
        gain = position - first
        for square in self.room.squares[leg.sections[position]]:
            found = struts_between(self.room, square, self.longest, leg.sections)
            for strut, other in islice(found, _ENOUGH):
                helped = 1.5 if self._is_helped(other) else 1.0
                yield _Choice(strut.cost / gain / helped, position, strut, other)

    def _columns(self, leg: RoutedLeg, first: int, position: int) -> Iterator[_Choice]:
        """Yield further columns that divide a leg at one of its sections."""
        excluded, gain = frozenset(leg.sections[1:-1]), position - first
        for square in self.room.squares[leg.sections[position]]:
            for column in props_from(self.room, square, excluded):
                other = self.room.section.get(column.squares[-1], -1)
                yield _Choice(column.cost / gain, position, column, other)

    def _is_helped(self, section: int) -> bool:
        """Tell whether a stretch of another leg that is too long contains a section well inside."""
        if section not in self._at:
            return False
        number, position = self._at[section]
        below = max(end for end in self._ends[number] if end <= position)
        above = min(end for end in self._ends[number] if end >= position)
        near = min(position - below, above - position)
        return 3 * near > above - below and self.legs[number].ratio(below, above) > self.ratio
