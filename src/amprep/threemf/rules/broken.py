"""What a package breaks: the rule, the first place, the expectation, and the number of places."""

from dataclasses import dataclass

MOST_RULES = 40
"""Different findings that are kept; further ones are counted as one."""

_LONGEST = 120


@dataclass(frozen=True)
class BrokenRule:
    """A rule of the specification that a package breaks.

    Attributes
    ----------
    rule
        Specification and chapter, for example ``3MF core 3.4.1``.
    expected
        What the rule demands.
    place
        The first place where it is broken.
    touches_parts
        Whether geometry, units or placement may be wrong because of it.
    count
        Number of places.
    """

    rule: str
    expected: str
    place: str
    touches_parts: bool
    count: int = 1

    def __str__(self) -> str:
        """The finding in one line."""
        more = f" and {self.count - 1} more" if self.count > 1 else ""
        return f"{self.rule}: {self.expected} ({self.place}{more})"


class BrokenRules:
    """Collects findings; equal ones are counted."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str], tuple[str, bool, int]] = {}

    def add(self, rule: str, expected: str, place: str, *, touches_parts: bool) -> None:
        """Add a finding; see `BrokenRule`."""
        key = (rule, expected)
        if key not in self._found and len(self._found) >= MOST_RULES:
            key = ("3MF", "no further rules may be broken")
        first, touches, count = self._found.get(key, (place, False, 0))
        self._found[key] = (first, touches or touches_parts, count + 1)

    def listed(self) -> tuple[BrokenRule, ...]:
        """Return the findings, those that may touch parts first."""
        rules = [
            BrokenRule(rule, expected, _printable(place), touches, count)
            for (rule, expected), (place, touches, count) in self._found.items()
        ]
        return tuple(sorted(rules, key=lambda each: not each.touches_parts))


def _printable(place: str) -> str:
    """Return text of a file as one short printable line."""
    line = "".join(char if char.isprintable() else " " for char in place)
    return line if len(line) <= _LONGEST else f"{line[:_LONGEST]}..."
