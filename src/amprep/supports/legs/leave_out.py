"""Leave out legs that stay too long for their width, and the supports that only they carry."""

from collections.abc import Callable
from itertools import count
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s, Ints
from amprep.geometry.voxels.grid import Grid
from amprep.model.counting import counted
from amprep.model.supports.edges import SupportEdges, square_keys
from amprep.supports.legs.find import RoutedLeg
from amprep.supports.legs.room import OpenVoxels
from amprep.supports.legs.sections import Sections, find_sections
from amprep.supports.legs.shorten import LegRules, LongLeg, long_leg, shorten_legs, too_long

_BRACED = 0.95
"""Fraction of the leg ratio from which legs are divided, because finished legs are a little longer and narrower."""

MUCH_ADDED = 0.25
"""Fraction of edges that bracing adds above which a note proposes wider supports."""

_ATTEMPTS = 3
"""Number of times that legs are left out and the remaining ones divided again; then they are only left out."""


class ShortLegs(NamedTuple):
    """Supports without a leg that is too long.

    Attributes
    ----------
    edges
        The edges that stay, with those of struts, further columns and thicker feet.
    lost
        ``(m,)`` bool, the squares below connectors that no support holds any more.
    divided, thickened
        Numbers of legs that struts or further columns divide, and that are wider in their lower part.
    left_out
        The legs that are left out.
    added
        Edges of struts, further columns and thicker feet, as a fraction of the routed edges that stay.
    """

    edges: SupportEdges
    lost: Bools
    divided: int
    thickened: int
    left_out: tuple[LongLeg, ...]
    added: float


def keep_legs_short(
    grid: Grid,
    edges: SupportEdges,
    held: tuple[Ints, Ints],
    rules: LegRules,
    opened: Callable[[int], OpenVoxels],
) -> ShortLegs:
    """Divide or thicken legs that are too long for their width, and leave out those for which there is no room.

    Strategy: what is left out held others, as struts led to it. So the legs that remain are looked at again, and
    divided again the first few times. Each round takes edges away, so there is an end.

    Parameters
    ----------
    grid
        The support grid.
    edges
        The edges of all supports, each with its part.
    held
        The squares ``(m, 3)`` below connectors, and the squares ``(f, 3)`` that stand on parts.
    rules
        Largest ratio, and extents of one cell.
    opened
        Returns the voxels that the supports of a part may use.
    """
    red, feet, routed = *held, edges
    braced = rules._replace(ratio=max(1.0, _BRACED * rules.ratio))
    lost = np.zeros(len(red), np.bool_)
    divided = thickened = 0
    left_out: list[LongLeg] = []
    for attempt in count():
        stood = np.concatenate([red[~lost], feet])
        if attempt < _ATTEMPTS:
            found = shorten_legs(grid, edges, stood, braced, opened)
            divided, thickened = divided + found.divided, thickened + found.thickened
            edges = SupportEdges.concatenate([edges, found.edges]).merged()
            if not found.left:
                break
        sections = find_sections(grid, edges, stood, rules.cell)
        legs = too_long(sections, rules.ratio, 0.0)
        if not legs:
            break
        left_out += [long_leg(leg, sections, grid) for leg in legs]
        edges, lost = without_edges(edges, _edges_of(legs, sections, edges), red, lost, feet)
    return ShortLegs(edges, lost, divided, thickened, tuple(left_out), _added(edges, routed))


def _added(edges: SupportEdges, routed: SupportEdges) -> float:
    """Return the number of edges that are not routed ones, as a fraction of the routed ones among them."""
    own, before = (np.column_stack([each.upper, each.lower, each.part]) for each in (edges, routed))
    distinct = len(np.unique(np.concatenate([own, before]), axis=0))
    added = distinct - len(np.unique(before, axis=0))
    return added / max(len(np.unique(own, axis=0)) - added, 1)


def _edges_of(legs: list[RoutedLeg], sections: Sections, edges: SupportEdges) -> Bools:
    """Tell which edges begin or end in a section between the ends of a leg."""
    inner = np.concatenate([np.array(leg.sections[1:-1]) for leg in legs])
    squares = square_keys(sections.square[np.isin(sections.section, inner)])
    return np.isin(square_keys(edges.upper), squares) | np.isin(square_keys(edges.lower), squares)


def without_edges(
    edges: SupportEdges, removed: Bools, red: Ints, lost: Bools, feet: Ints
) -> tuple[SupportEdges, Bools]:
    """Return the edges that stand and carry something after some are removed, and the squares without support.

    Parameters
    ----------
    edges
        The edges of all supports.
    removed
        ``(n,)`` bool, the edges that go.
    red, lost
        ``(m, 3)`` squares below connectors, and those that have lost their support before.
    feet
        ``(f, 3)`` squares that stand on parts.
    """
    stands = _stand(edges, ~removed, square_keys(feet))
    grounded = np.concatenate([square_keys(edges.upper[stands]), square_keys(feet)])
    red_keys = square_keys(red)
    lost = lost | ~(np.isin(red_keys, grounded) | (red[:, 0] == 0))
    kept = edges[stands]
    return kept[leads_to(kept, red_keys[~lost])], lost


def _stand(edges: SupportEdges, chosen: Bools, feet: Int64s) -> Bools:
    """Tell from which of the chosen edges others lead down to the plate or to a foot, plane by plane from below."""
    upper, lower = square_keys(edges.upper), square_keys(edges.lower)
    stands = chosen & ((edges.plane == 1) | np.isin(lower, feet))
    below = np.empty(0, np.int64)
    for plane in np.unique(edges.plane):
        own = np.flatnonzero(edges.plane == plane)
        stands[own] |= chosen[own] & np.isin(lower[own], below)
        below = upper[own[stands[own]]]
    return np.asarray(stands)


def leads_to(edges: SupportEdges, ends: Int64s) -> Bools:
    """Tell which edges lead up to one of the squares with the keys `ends`; plane by plane from above."""
    upper, lower = square_keys(edges.upper), square_keys(edges.lower)
    used = np.zeros(len(edges), np.bool_)
    above = np.empty(0, np.int64)
    for plane in np.unique(edges.plane)[::-1]:
        own = np.flatnonzero(edges.plane == plane)
        own = own[np.isin(upper[own], ends) | np.isin(upper[own], above)]
        used[own] = True
        above = lower[own]
    return used


def words_of(legs: ShortLegs, ratio: float) -> tuple[str, ...]:
    """Return one sentence about what was done with the legs, none if nothing was to be done."""
    done = []
    if legs.divided:
        done.append(f"struts and columns divide {counted(legs.divided, 'leg')}")
    if legs.thickened:
        done.append(f"{counted(legs.thickened, 'leg')} made thicker below")
    if done:
        more = "; a wider cell or a larger pitch would need less" if legs.added > MUCH_ADDED else ""
        done.append(f"this adds {100 * legs.added:.0f} % to the edges of the supports{more}")
    if legs.left_out:
        worst = max(legs.left_out)
        x, y, z = worst.position_mm
        done.append(
            f"{counted(len(legs.left_out), 'leg')} left out that would be longer than {ratio:g} widths, because no "
            f"voxels near are free for a strut (the worst would be {worst.ratio:.1f} widths long, at "
            f"{x:.0f}, {y:.0f}, {z:.0f} mm)"
        )
    return (f"legs: {'; '.join(done)}",) if done else ()
