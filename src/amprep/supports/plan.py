"""Plan the supports of a build: overhangs, grid, red squares, routing, groups (thesis 3.2)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Bytes, Ints
from amprep.geometry.voxels.grid import Grid
from amprep.model.build import PlacedPart
from amprep.model.build_volume import BuildVolume
from amprep.model.control import Progress, Stop
from amprep.model.counting import counted
from amprep.model.mesh import Mesh
from amprep.model.supports import SLENDER
from amprep.model.supports.edges import SupportEdges, square_keys
from amprep.overhangs.of_part import PartOverhangs, overhangs_of
from amprep.supports.grid.red_squares import Choose, SupportGrid, make_grid
from amprep.supports.grid.spacing import are_beside, space_contacts, steps_within
from amprep.supports.grid.taken import close_met, close_taken, taken_by
from amprep.supports.grid.territory import PartTerritory, find_territories
from amprep.supports.layout import SupportLayout, groups_of
from amprep.supports.legs.cell import CellProperties
from amprep.supports.legs.leave_out import keep_legs_short, words_of
from amprep.supports.legs.room import OpenVoxels
from amprep.supports.legs.shorten import LegRules
from amprep.supports.routes.by_part import Routed, route_apart, route_together
from amprep.supports.routes.network import Route, SupportNetwork
from amprep.supports.routes.on_part import stand_on_parts
from amprep.supports.rules import PlanningRules

__all__ = ["Choose", "PassScope", "PlanningRules", "Route", "SupportLayout", "plan_supports"]


@dataclass(frozen=True, eq=False)
class PassScope:
    """What one pass of planning supports, and what it has to keep out of.

    Attributes
    ----------
    overhangs
        The overhangs of each part that are to be supported; None for all that the rules find.
    choose
        Chooses the red squares to connect; None chooses all.
    earlier
        Layouts of earlier passes, whose voxels are closed.
    kept
        Meshes of supports that exist already; the voxels that they meet are closed.
    """

    overhangs: Sequence[PartOverhangs] | None = None
    choose: Choose | None = None
    earlier: Sequence[SupportLayout] = ()
    kept: Sequence[Mesh] = ()

    def close(self, voxels: Bytes, grid: Grid) -> None:
        """Close the voxels of other supports, in place."""
        if self.earlier:
            close_taken(voxels, grid, taken_by(self.earlier))
        close_met(voxels, grid, self.kept)


EVERYTHING = PassScope()
"""The scope of a single pass: all overhangs that the rules find."""


class _Supports(NamedTuple):
    """Edges, columns that end on parts, connected red squares, notes for the user, and reasons for other squares."""

    edges: SupportEdges
    feet: Ints
    connected: Bools
    notes: tuple[str, ...]
    reasons: tuple[str, ...]


def plan_supports(
    parts: Sequence[PlacedPart],
    space: BuildVolume,
    rules: PlanningRules,
    *,
    route: Route,
    cell: CellProperties | None = None,
    scope: PassScope = EVERYTHING,
    stop: Stop,
    progress: Progress,
) -> SupportLayout:
    """Find the overhangs, lay the grid, and route every red square to the plate (thesis 3.1 and 3.2).

    Parameters
    ----------
    parts
        The parts of the build.
    space
        The build volume.
    rules
        Rules for overhangs, grid, routing and bracing.
    route
        The router; it may be called once for each part.
    cell
        The cell that replaces the edges; None for one that fills its square and takes as much material on any edge.
    scope
        The overhangs and red squares of this pass, and the layouts of earlier passes.
    stop
        Ends the routing; red squares not routed by then are listed as unconnected.
    progress
        Progress callback.

    Raises
    ------
    JobError
        If the grid takes more memory than allowed.
    PluginError
        If the router returns a plan that `amprep.checks.supports.plan.check_plan` rejects.
    """
    cell = CellProperties() if cell is None else cell
    overhangs = [overhangs_of(each, rules) for each in parts] if scope.overhangs is None else scope.overhangs
    progress(0.05, "overhangs found")
    laid = make_grid(parts, overhangs, space, rules, scope.choose, scope.close)
    progress(0.15, "grid laid")
    territories = find_territories(parts, laid, rules)
    every = SupportNetwork(laid, rules, cell.material, route, stop, territories)
    network, routed, close = _route_spaced(every, overhangs, rules, progress)
    laid, territories = network.laid, tuple(network.territories)
    notes = [words if part is None else f"{parts[part].label}: {words}" for part, words in network.notes]
    supports = _shorten_legs(laid, territories, _ground(laid, territories, routed, rules), rules, cell)
    supports = supports._replace(notes=(*notes, *supports.notes))
    layout = _layout(parts, overhangs, laid, supports)
    return replace(layout, territories=territories, contact_spacing=rules.contact_spacing_mm, close=close)


def _route_spaced(
    every: SupportNetwork, overhangs: Sequence[PartOverhangs], rules: PlanningRules, progress: Progress
) -> tuple[SupportNetwork, Routed, Bools]:
    """Route the red squares that the contact spacing needs; where one stays unconnected, also those beside it.

    Returns
    -------
    The network of these red squares, its routes, and the squares where contacts are at most half the spacing apart.
    """
    spacing, red = rules.contact_spacing_mm, every.red
    if not spacing or not len(red.part):
        return every, _route(every, rules, progress), np.zeros(len(red.part), np.bool_)
    reachable = every.reachable()
    chosen, close = space_contacts(
        every.laid, overhangs, reachable, spacing=spacing, rules=rules, layer=rules.layer_mm
    )
    network = every.only(chosen)
    routed = _route(network, rules, progress)
    if every.stop():
        return network, routed, close[chosen]
    lost = np.flatnonzero(chosen)[[reason != "" for reason in routed.reasons]]
    more = ~chosen & are_beside(red, lost[reachable[lost]], steps_within(spacing, every.laid.grid.pitch))
    if more.any():
        chosen = chosen | more
        network = every.only(chosen)
        routed = _route(network, rules, progress)
    return network, routed, close[chosen]


def _route(network: SupportNetwork, rules: PlanningRules, progress: Progress) -> Routed:
    def routing(fraction: float, message: str) -> None:
        progress(0.15 + 0.85 * fraction, message)

    if rules.share_between_parts == "avoid":
        return route_apart(network, routing)
    return route_together(network, routing)


def _ground(
    laid: SupportGrid, territories: Sequence[PartTerritory], routed: Routed, rules: PlanningRules
) -> _Supports:
    """Let red squares without a path to the plate stand on their own part, if the rules allow it."""
    connected = np.array([reason == "" for reason in routed.reasons], np.bool_)
    left = ~connected & (rules.grounding == "anywhere")
    grounded = stand_on_parts(laid, left, routed.edges, territories)
    edges = SupportEdges.concatenate([routed.edges, grounded.edges]).merged()
    notes = (f"{counted(len(grounded.feet), 'column')} on parts, as supports.grounding allows",)
    return _Supports(
        edges,
        grounded.feet,
        connected | grounded.connected,
        notes if len(grounded.feet) else (),
        tuple(routed.reasons),
    )


def _shorten_legs(
    laid: SupportGrid,
    territories: Sequence[PartTerritory],
    supports: _Supports,
    rules: PlanningRules,
    cell: CellProperties,
) -> _Supports:
    """Brace, thicken or leave out legs that are too long for their width, if the rules limit that."""
    if not rules.leg_ratio or not len(supports.edges):
        return supports
    ends = np.flatnonzero(supports.connected)
    opened = [OpenVoxels(laid.voxels, each.first, each.opened) for each in territories]
    legs = keep_legs_short(
        laid.grid,
        supports.edges,
        (laid.red.square[ends], supports.feet[:, :3]),
        LegRules(rules.leg_ratio, cell.extents_in(laid.grid.pitch)),
        opened.__getitem__ if opened else lambda _: OpenVoxels(laid.voxels),
    )
    connected, reasons = supports.connected.copy(), np.array(supports.reasons, object)
    connected[ends[legs.lost]] = False
    reasons[ends[legs.lost]] = SLENDER
    stood_on = square_keys(np.concatenate([legs.edges.lower, laid.red.square[connected]]))
    return _Supports(
        legs.edges,
        supports.feet[np.isin(square_keys(supports.feet[:, :3]), stood_on)],
        connected,
        (*supports.notes, *words_of(legs, rules.leg_ratio)),
        tuple(reasons.tolist()),
    )


def _layout(
    parts: Sequence[PlacedPart],
    overhangs: Sequence[PartOverhangs],
    laid: SupportGrid,
    supports: _Supports,
) -> SupportLayout:
    """Return the layout, with the groups that the supports form."""
    connected = supports.connected
    red_group, edge_group, group_parts = groups_of(supports.edges, laid.red, connected, len(parts))
    shared = [", ".join(parts[part].label for part in group) for group in group_parts if len(group) > 1]
    return SupportLayout(
        grid=laid.grid,
        voxels=laid.voxels,
        overhangs=tuple(overhangs),
        red=laid.red,
        connected=connected,
        reasons=tuple(
            "" if done else why for done, why in zip(connected.tolist(), supports.reasons, strict=True)
        ),
        feet=supports.feet,
        edges=replace(supports.edges, group=edge_group),
        red_group=red_group,
        group_parts=group_parts,
        notes=supports.notes,
        shared=tuple(f"share supports: {names}" for names in shared),
    )
