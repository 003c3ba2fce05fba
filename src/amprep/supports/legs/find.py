"""Find legs on the sections of the supports, and how long they are for their width."""

from dataclasses import dataclass

import numpy as np

from amprep.geometry.supports.bends import without_bends
from amprep.supports.legs.sections import Sections


@dataclass(frozen=True)
class RoutedLeg:
    """A chain of sections, each with one section above and one below, between two that branch or are held.

    Attributes
    ----------
    sections
        The sections from the lower end to the upper end, both ends included.
    lengths
        Length (mm) of the link above each section but the last.
    widths
        Width (mm) of each section; places inside that are wider in one or two sections only, such as bends,
        do not count.
    touching
        Length (widths) along which a strut or branch touches a leg that ends there, without dividing it.
    held
        Whether the plate or a part holds the lower and the upper end; then nothing touches the leg there.
    """

    sections: tuple[int, ...]
    lengths: tuple[float, ...]
    widths: tuple[float, ...]
    touching: float
    held: tuple[bool, bool]

    def ratio(self, first: int = 0, last: int | None = None) -> float:
        """Return the greatest ratio of length to width of a stretch between two of the sections.

        A stretch is as wide as the widest of the sections between its ends. So a leg may be narrow at its top and
        must be wider below, in proportion to the length above.

        Parameters
        ----------
        first, last
            Positions of the two sections in the leg; default: the whole leg.
        """
        last = len(self.lengths) if last is None else last
        inner = self.widths[first + 1 : last]
        below = self.touching * (not (first == 0 and self.held[0]))
        beyond = self.touching * (not (last == len(self.lengths) and self.held[1]))
        worst = 0.0
        for width in set(inner):
            start: int | None = None
            for number, own in enumerate(inner):
                if own > width:
                    start = None
                    continue
                start = number if start is None else start
                length = sum(self.lengths[first + start : first + number + 2])
                touching = below * (start == 0) + beyond * (number == len(inner) - 1)
                worst = max(worst, length / width + touching)
        return worst


def find_legs(sections: Sections, touching: float = 0.0) -> list[RoutedLeg]:
    """Return the legs of all supports that have sections between their ends, in the order of their upper ends.

    Parameters
    ----------
    sections
        The sections of the supports.
    touching
        Length (widths) along which a strut or branch touches a leg that ends there, without dividing it.
    """
    count = len(sections.width)
    upper, lower = sections.link.T
    above, below = np.bincount(lower, minlength=count), np.bincount(upper, minlength=count)
    inner = (above == 1) & (below == 1) & ~sections.held
    link_below = np.zeros(count, np.int64)
    link_below[upper] = np.arange(len(upper))
    lengths, widths = sections.length.tolist(), sections.width.tolist()
    after, is_inner, below_of = lower.tolist(), inner.tolist(), link_below.tolist()
    held = sections.held.tolist()
    legs = []
    for link in np.flatnonzero(~inner[upper] & inner[lower]).tolist():
        links = [link]
        while is_inner[after[links[-1]]]:
            links.append(below_of[after[links[-1]]])
        chain = [*(after[each] for each in reversed(links)), int(upper[link])]
        inner_widths = without_bends([widths[each] for each in chain[1:-1]])
        legs.append(
            RoutedLeg(
                tuple(chain),
                tuple(lengths[each] for each in reversed(links)),
                (widths[chain[0]], *inner_widths, widths[chain[-1]]),
                touching,
                (held[chain[0]], held[chain[-1]]),
            )
        )
    return legs
