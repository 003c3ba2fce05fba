"""Propose orientations of a part: try many directions quickly, measure the best exactly, and choose a few."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.errors import JobError
from amprep.geometry.bounding.boxes.orientation import smallest_box_about_z, upright_rotation
from amprep.geometry.orientation.choice import apart, balanced, non_dominated, ranked
from amprep.model.control import Progress, Stop, silent
from amprep.model.orientation import OrientationFigures, OrientationProposal, OrientationRules
from amprep.model.part import Part
from amprep.model.rotations import quarter_turns
from amprep.model.supports.rules import SupportRules
from amprep.orienting.candidates import TriedDirections, TurnablePart, try_directions, turnable_part
from amprep.orienting.measure import measure_orientation, touched_area

# Strategy. Three sieves, each finer and dearer than the one before: quick figures of more than a thousand directions,
# exact figures of the best of these by each objective, and planned supports of the few that are proposed. An
# orientation is proposed only if no other one is at least as good by every objective; those that are the best by one
# objective come first, then those with the best balance of all.

DIRECTIONS_APART_DEG = 5.0
"""Least angle between the vertical directions of two proposals."""

_TOUCHED_MM2 = 0.05

Routed = Callable[[Part, Floats], tuple[float, int]]
"""Plans the supports of a part in an orientation; returns their volume (mm3) and the number of unsupported regions."""


class OrientationSearch(NamedTuple):
    """How thoroughly orientations are searched.

    Attributes
    ----------
    measured
        Number of orientations that are measured exactly.
    proposals
        Number of orientations that are proposed.
    fits
        Tells which rotations ``(k, 3, 3)`` fit the printer; None where all do.
    routed
        Plans supports for the best ones and for the proposals; None to leave it out.
    compared
        Number of orientations with the least estimate of support for which supports are planned, if at all.
    """

    measured: int = 10
    proposals: int = 5
    fits: Callable[[Floats], Bools] | None = None
    routed: Routed | None = None
    compared: int = 8


class FoundOrientations(NamedTuple):
    """The result of a search.

    Attributes
    ----------
    tried
        Number of directions with quick figures.
    drawn
        Figures of the part as drawn.
    proposals
        Proposals, the best supported one first.
    """

    tried: int
    drawn: OrientationProposal
    proposals: tuple[OrientationProposal, ...]


def propose_orientations(
    part: Part,
    rules: SupportRules,
    lift: float,
    restricted: OrientationRules,
    settings: OrientationSearch,
    *,
    stop: Stop,
    progress: Progress = silent,
) -> FoundOrientations:
    """Return the orientations in which a part costs the least, by several objectives.

    Parameters
    ----------
    part
        The part.
    rules
        Overhang angle and limits.
    lift
        Height (mm) of its lowest point above the plate.
    restricted
        What restricts its orientation.
    settings
        How thorough the search is.
    stop
        Ends the search early, with the orientations that were measured so far.
    progress
        Called with the fraction that is done and a message.

    Raises
    ------
    JobError
        When no direction is allowed, or the rules name faces that the part does not have.
    """
    turnable = turnable_part(part, rules, lift, restricted)
    found = try_directions(turnable)
    tried = len(found.directions)
    if not tried:
        raise JobError(
            f"part {part.name!r} has no allowed orientation; name fewer faces that restrict it, or allow more tilt"
        )
    rotations = [
        rotation_to(turnable, found.directions[row]) for row in _shortlist(turnable, found, settings)
    ]
    if not rotations:
        raise JobError(f"part {part.name!r} fits the build volume in none of its allowed orientations")
    measured: list[OrientationProposal] = []
    for number, rotation in enumerate(rotations):
        if measured and stop():
            break
        progress(number / len(rotations), f"{part.name}: {tried} directions tried")
        if touched_area(part, rotation, rules, lift, restricted.no_contact) <= _TOUCHED_MM2:
            measured.append(OrientationProposal(rotation, measure_orientation(part, rotation, rules, lift)))
    if not measured:
        raise JobError(
            f"part {part.name!r} has no orientation in which supports touch none of the faces named"
        )
    drawn = OrientationProposal(np.eye(3), measure_orientation(part, np.eye(3), rules, lift), ("as drawn",))
    routed = settings.routed
    if routed is None:
        return FoundOrientations(tried, drawn, _with_merits(_chosen(measured, settings.proposals)))

    def supported(proposals: list[OrientationProposal]) -> Iterator[OrientationProposal]:
        for number, each in enumerate(proposals):
            progress(number / len(proposals), f"{part.name}: supports of {len(proposals)} orientations")
            yield _with_supports(part, each, routed, stop)

    measured = _ordered(measured)
    best = list(supported([drawn, *measured[: settings.compared]]))
    drawn, measured[: settings.compared] = best[0], best[1:]
    chosen = list(supported(_chosen(measured, settings.proposals)))
    return FoundOrientations(tried, drawn, _with_merits(chosen))


def rotation_to(part: TurnablePart, direction: Floats) -> Floats:
    """Return the rotation that turns a direction upwards and the part into the smallest box about the vertical.

    Of its four quarter turns the one nearest to the position as drawn.
    """
    upright = upright_rotation(direction)
    upright = smallest_box_about_z(part.outer_points @ upright.T)[1] @ upright
    turned = quarter_turns() @ upright
    nearest = turned[np.trace(turned, axis1=1, axis2=2).round(9).argmax()]
    whole = np.rint(nearest) + 0.0
    return np.asarray(whole if np.abs(whole - nearest).max() < 1e-9 else nearest)


def _shortlist(part: TurnablePart, found: TriedDirections, settings: OrientationSearch) -> list[int]:
    """Return the candidates to measure: half of them cost the least, the others are good by other objectives.

    The area of the projection stands for the base of the box.
    """
    directions, quick, costs = found
    boxes, tipping = quick.height * part.projected_areas(directions), part.tipping(directions)
    orders = [
        ranked(boxes, costs),
        ranked(quick.height, costs),
        ranked(-tipping, costs),
        ranked(quick.overhang + quick.edge_length, costs),
        ranked(balanced(np.column_stack([costs, boxes, quick.height, -tipping]))),
    ]
    fits, most = settings.fits, settings.measured

    @cache
    def allowed(row: int) -> bool:
        return fits is None or bool(fits(rotation_to(part, directions[row])[None])[0])

    smallest = _smallest_box(part, directions, boxes)
    cheap = ranked(costs, quick.height).tolist()
    chosen = apart([smallest, *cheap], directions, max(most // 2, 2), DIRECTIONS_APART_DEG, allowed)
    others = (int(row) for place in zip(*orders, strict=True) for row in place)
    return apart([*chosen, *others], directions, most, DIRECTIONS_APART_DEG, allowed)


def _smallest_box(part: TurnablePart, directions: Floats, bounds: Floats) -> int:
    """Return the direction ``(k, 3)`` along which the smallest box stands; `bounds` are lower bounds on the volumes."""
    best, row = np.inf, 0
    for number in np.argsort(bounds, kind="stable").tolist():
        if bounds[number] * (1.0 - 1e-12) >= best:
            break
        volume = smallest_box_about_z(part.outer_points @ upright_rotation(directions[number]).T)[0]
        if volume < best * (1.0 - 1e-12):
            best, row = volume, number
    return row


def _costs(proposals: list[OrientationProposal]) -> Floats:
    """Return the figures ``(k, 5)`` that are to be small, in the order of `_MERITS`."""
    figures = [proposal.figures for proposal in proposals]
    others = [
        (each.overhang_mm2 + each.edges_mm, each.box_mm3, each.height_mm, -each.tipping_deg)
        for each in figures
    ]
    return np.round(np.column_stack([_support_costs(figures), others]), 6)


def _support_costs(figures: list[OrientationFigures]) -> Floats:
    """Return the estimates of support ``(k,)``, or the volumes of supports if they were planned for some.

    Then those come first that leave nothing unsupported, and those without planned supports last.
    """
    estimates = np.array([each.estimate for each in figures])
    planned = np.array(
        [np.nan if each.support_mm3 is None else each.support_mm3 + each.hold_mm3 for each in figures]
    )
    if np.isnan(planned).all():
        return estimates
    most = float(np.nanmax(planned)) + 1.0
    open_ones = np.array([each.unsupported > 0 for each in figures])
    return np.where(np.isnan(planned), 2.0 * most + estimates, planned + most * open_ones)


_MERITS = ("support", "overhang", "box", "height", "stability")


def _chosen(measured: list[OrientationProposal], most: int) -> list[OrientationProposal]:
    """Return the proposals: the best by each objective, then those with the best balance.

    Orientations that another one beats by every objective are proposed only where there are too few others.
    """
    costs = _costs(measured)
    balance = balanced(costs)
    unbeaten = non_dominated(costs)
    best = [int(ranked(costs[:, column], ~unbeaten, balance)[0]) for column in range(costs.shape[1])]
    order = ranked(~unbeaten, balance).tolist()
    rows = list(dict.fromkeys([best[0], *best[2:4], order[0], *best, *order]))[:most]
    return [measured[row] for row in rows]


def _ordered(proposals: list[OrientationProposal]) -> list[OrientationProposal]:
    """Return proposals by their support, those that are alike by their height."""
    costs = _costs(proposals)
    return [proposals[row] for row in ranked(costs[:, 0], costs[:, _MERITS.index("height")])]


def _with_merits(proposals: list[OrientationProposal]) -> tuple[OrientationProposal, ...]:
    """Return the proposals by their support, with what each of them is the best for among them."""
    proposals = _ordered(proposals)
    costs = _costs(proposals)
    merits: list[list[str]] = [[] for _ in proposals]
    for name, row in zip(_MERITS, costs.argmin(axis=0).tolist(), strict=True):
        merits[row].append(name)
    if len(proposals) > 1:
        merits[int(balanced(costs).argmin())].append("balance")
    return tuple(replace(each, merits=tuple(names)) for each, names in zip(proposals, merits, strict=True))


def _with_supports(
    part: Part, proposal: OrientationProposal, routed: Routed, stop: Stop
) -> OrientationProposal:
    if stop() or proposal.figures.support_mm3 is not None:
        return proposal
    volume, unsupported = routed(part, proposal.rotation)
    return replace(proposal, figures=replace(proposal.figures, support_mm3=volume, unsupported=unsupported))
