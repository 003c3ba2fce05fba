"""Divide or leave out legs of finished solids that are too long for their width.

Planning knows the squares that supports use, but not what territories, walls and holes cut from the finished solids. So
the solids are measured as well. Legs above the limit are divided by struts or further columns; those that are there
after that go, and with them what only they carry.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools
from amprep.measures.legs import long_stretches
from amprep.model import Mesh, PlacedPart, Stop, SupportBody
from amprep.model.supports import SLENDER
from amprep.model.supports.edges import square_keys
from amprep.supports.layout import SupportLayout
from amprep.supports.legs.divide_finished import FinishedLeg, divide_finished
from amprep.supports.legs.leave_out import without_edges
from amprep.workers import share_out

_BESIDE = 0.25
"""Distance (in pitches) from the box around a leg up to which axes of edges belong to it."""

_ROUNDS_OF_STRUTS = 2
"""Number of rounds that divide legs; further ones leave them out."""

_MOST_ROUNDS = 40
"""Largest number of rounds; the distance grows by a pitch in each in which nothing goes."""


class BuiltSupports(NamedTuple):
    """Support bodies, and the layout with the supports that were left out."""

    bodies: tuple[SupportBody, ...]
    layout: SupportLayout


def without_long_legs(
    build: Callable[[SupportLayout], tuple[SupportBody, ...]],
    layout: SupportLayout,
    parts: Sequence[PlacedPart],
    ratio: float,
    stop: Stop | None = None,
) -> BuiltSupports:
    """Build supports, and again with legs divided or left out that are too long, until there is none.

    Parameters
    ----------
    build
        Builds the bodies of a layout.
    layout
        Routed supports of the build.
    parts
        Placed parts of the build.
    ratio
        Largest ratio of length to width of a leg; 0 for no limit.
    stop
        Ends the work early: legs that are too long may then be left. None for no limit.

    Notes
    -----
    `build` may return a body of an earlier call where nothing of it changed; it is measured once.
    """
    bodies = build(layout)
    meshes = [placed.mesh for placed in parts]
    measured: dict[int, _MeasuredBody] = {}
    beside = _BESIDE * layout.grid.pitch
    for number in range(_MOST_ROUNDS * (ratio > 0.0)):
        if stop is not None and stop():
            break
        measured = _all_measured(bodies, measured, layout, meshes, ratio)
        legs = [leg for each in measured.values() for leg in each.legs]
        if not legs:
            break
        if number < _ROUNDS_OF_STRUTS:
            divided = divide_finished(layout, legs, ratio)
            if divided is not layout:
                layout, bodies = divided, build(divided)
                continue
        reduced = _reduced(layout, legs, beside)
        if len(reduced.edges) == len(layout.edges) and (reduced.connected == layout.connected).all():
            beside += layout.grid.pitch
            continue
        layout, bodies = reduced, build(reduced)
    return BuiltSupports(bodies, layout)


class _MeasuredBody(NamedTuple):
    """A body, and its legs that are too long; the reference keeps its identity from being used again."""

    body: SupportBody
    legs: list[FinishedLeg]


def _all_measured(
    bodies: Sequence[SupportBody],
    known: Mapping[int, _MeasuredBody],
    layout: SupportLayout,
    meshes: Sequence[Mesh],
    ratio: float,
) -> dict[int, _MeasuredBody]:
    """Return the legs of bodies that are too long, by the identity of each body; known ones are not measured again."""
    new = [body for body in bodies if id(body) not in known]
    work = [float(len(body.mesh.triangles)) for body in new]
    found = share_out(lambda number: _long_legs_of(new[number], layout, meshes, ratio), work)
    measured = {id(body): _MeasuredBody(body, legs) for body, legs in zip(new, found, strict=True)}
    return {id(body): measured.get(id(body)) or known[id(body)] for body in bodies}


def _long_legs_of(
    body: SupportBody, layout: SupportLayout, meshes: Sequence[Mesh], ratio: float
) -> list[FinishedLeg]:
    """Return the legs of a body that are too long."""
    if body.surface or not len(body.mesh.triangles):
        return []
    group = layout.group_parts.index(body.parts)
    held = [meshes[part] for part in body.parts]
    found = long_stretches(body.mesh, layout.grid.step, ratio, held)
    return [FinishedLeg(group, boxes) for boxes in found]


def _cross(layout: SupportLayout, leg: FinishedLeg, beside: float) -> Bools:
    """Tell which edges of its group ``(n,)`` cross the box in the middle of a leg, grown by a distance (mm)."""
    grid, edges = layout.grid, layout.edges
    low, high = leg.middle
    middle = (low[2] + high[2]) / 2.0
    top = grid.origin[2] + edges.plane * grid.step
    fraction = np.clip((top - middle) / grid.step, 0.0, 1.0)[:, None]
    ends = [grid.origin[:2] + (each[:, :0:-1] + 0.5) * grid.pitch for each in (edges.upper, edges.lower)]
    axis = (1.0 - fraction) * ends[0] + fraction * ends[1]
    inside = ((axis >= low[:2] - beside) & (axis <= high[:2] + beside)).all(axis=1)
    at_height = (top >= middle - beside) & (top - grid.step <= middle + beside)
    return np.asarray(inside & at_height & (edges.group == leg.group))


def _end_on_plate(layout: SupportLayout, leg: FinishedLeg, beside: float) -> Bools:
    """Tell which red squares on the plate ``(m,)``, below which there is no edge, are in its box, grown (mm)."""
    grid, square = layout.grid, layout.red.square
    axis = grid.origin[:2] + (square[:, :0:-1] + 0.5) * grid.pitch
    inside = ((axis >= leg.middle[0, :2] - beside) & (axis <= leg.middle[1, :2] + beside)).all(axis=1)
    low_enough = leg.middle[0, 2] <= (layout.red.rise + 1) * grid.step
    return np.asarray(inside & low_enough & (square[:, 0] == 0) & (layout.red_group == leg.group))


def _reduced(layout: SupportLayout, legs: Sequence[FinishedLeg], beside: float) -> SupportLayout:
    """Return a layout without the edges near legs (mm), and without what only they carry."""
    removed = np.logical_or.reduce([_cross(layout, leg, beside) for leg in legs])
    gone = np.logical_or.reduce([_end_on_plate(layout, leg, beside) for leg in legs])
    ends = np.flatnonzero(layout.connected)
    red, feet = layout.red.square[ends], layout.feet
    edges, lost = without_edges(layout.edges, removed, red, gone[ends], feet[:, :3])
    connected, reasons = layout.connected.copy(), list(layout.reasons)
    for each in ends[lost].tolist():
        connected[each], reasons[each] = False, SLENDER
    stood_on = square_keys(np.concatenate([edges.lower, red[~lost]]))
    return replace(
        layout,
        connected=connected,
        reasons=tuple(reasons),
        edges=edges,
        red_group=np.where(connected, layout.red_group, -1),
        feet=feet[np.isin(square_keys(feet[:, :3]), stood_on)],
    )
