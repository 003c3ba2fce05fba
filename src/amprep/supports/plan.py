"""Plans the supports of a build: needs, grid, red squares, routing, groups (thesis 3.2)."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Bytes, Ints
from amprep.geometry.overhangs.regions import Overhangs
from amprep.geometry.voxels.grid import Grid
from amprep.model.build import PlacedPart
from amprep.model.build_volume import BuildVolume
from amprep.model.control import Progress, Stop
from amprep.model.mesh import Mesh
from amprep.model.support_edges import SupportEdges
from amprep.overhangs.of_part import needs_of
from amprep.supports.grid.red_squares import RedSquares, close_gap, red_squares
from amprep.supports.grid.sizing import choose_pitch, frame_of
from amprep.supports.grid.voxel_states import PartVoxels, coloured, voxels_of
from amprep.supports.layout import SupportLayout, groups_of
from amprep.supports.routes.bracing import join_columns
from amprep.supports.routes.by_part import Routed, route_apart, route_together
from amprep.supports.routes.network import Network, Route
from amprep.supports.routes.on_part import stand_on_parts
from amprep.supports.rules import Wishes

__all__ = ["Route", "SupportLayout", "Wishes", "choose_pitch", "plan_supports"]

Only = Callable[[Bytes, RedSquares], Bools]
"""Tells from the voxels which red squares to connect."""


class _Needs(NamedTuple):
    """What needs support, part by part: meshes in build coordinates, and indices into them."""

    meshes: tuple[Mesh, ...]
    overhangs: tuple[Overhangs, ...]


class _Laid(NamedTuple):
    """The grid: its voxels, how many parts meet each, the voxels of each part, and the red squares."""

    frame: Grid
    voxels: Bytes
    meeting: Bytes
    blocks: tuple[PartVoxels, ...]
    red: RedSquares


class _Standing(NamedTuple):
    """Supports that stand: edges, feet on parts, which red squares are held."""

    edges: SupportEdges
    feet: Ints
    connected: Bools
    notes: tuple[str, ...]


def plan_supports(
    parts: Sequence[PlacedPart],
    space: BuildVolume,
    wishes: Wishes,
    *,
    route: Route,
    only: Only | None = None,
    stop: Stop,
    progress: Progress,
) -> SupportLayout:
    """Find what needs support, lay the grid, and route every red square to the plate (thesis 3.1 and 3.2).

    Parameters
    ----------
    route
        The chosen router; it may be called once for each part.
    only
        Red squares that it does not name are left out; None connects all.
    stop
        Ends the routing; what has no way by then is listed.

    Raises
    ------
    JobError
        When the grid takes more memory than allowed.
    PluginError
        When the router returns a plan that breaks its promise.
    """
    needs = _find_needs(parts, wishes)
    progress(0.05, "overhangs found")
    laid = _lay_grid(parts, needs, space, wishes, only)
    progress(0.15, "grid laid")
    network = Network(laid.frame, laid.voxels, laid.red, wishes.rules, route, stop)
    routed = _route(network, wishes, progress)
    told = [words if part is None else f"{parts[part].label}: {words}" for part, words in network.notes]
    standing = _joined(laid, _grounded(laid, routed, wishes), wishes)
    return _layout(parts, needs, laid, standing, routed.reasons, told)


def _find_needs(parts: Sequence[PlacedPart], wishes: Wishes) -> _Needs:
    found = [
        needs_of(
            placed,
            overhang_angle_deg=wishes.overhang_angle_deg,
            least_area=wishes.least_area,
            least_length=wishes.least_length,
        )
        for placed in parts
    ]
    return _Needs(tuple(each.mesh for each in found), tuple(each.overhangs for each in found))


def _lay_grid(
    parts: Sequence[PlacedPart], needs: _Needs, space: BuildVolume, wishes: Wishes, only: Only | None
) -> _Laid:
    """Lay the grid, colour its voxels, find the red squares, and close what is too near to parts."""
    angle, memory, gap = wishes.strut_angle_deg, wishes.memory_mb, wishes.gap
    pitch = wishes.pitch or choose_pitch(parts, space, angle, memory)
    frame = frame_of(*needs, space, pitch=pitch, strut_angle_deg=angle, memory_mb=memory)
    blocks = tuple(
        voxels_of(mesh, own, frame, gap=gap, solid=placed.part.is_solid)
        for placed, mesh, own in zip(parts, *needs, strict=True)
    )
    voxels, meeting = coloured(frame, space, blocks)
    red = red_squares(voxels, meeting, blocks)
    if only is not None:
        keep = only(voxels, red)
        red = RedSquares(*(each[keep] for each in red))
    if gap > 0:
        close_gap(voxels, blocks, red, gap=gap, step=frame.step, overhang_angle_deg=wishes.overhang_angle_deg)
    return _Laid(frame, voxels, meeting, blocks, red)


def _route(network: Network, wishes: Wishes, progress: Progress) -> Routed:
    def routing(share: float, words: str) -> None:
        progress(0.15 + 0.85 * share, words)

    if wishes.share_between_parts == "avoid":
        return route_apart(network, routing)
    return route_together(network, routing)


def _grounded(laid: _Laid, routed: Routed, wishes: Wishes) -> _Standing:
    """Stand what found no way to the plate on the part it belongs to, where that is allowed."""
    connected = np.array([reason == "" for reason in routed.reasons], np.bool_)
    left = ~connected & (wishes.grounding == "anywhere")
    grounded = stand_on_parts(laid.voxels, laid.meeting, laid.blocks, laid.red, left, routed.edges)
    edges = SupportEdges.concatenate([routed.edges, grounded.edges]).merged()
    notes = (f"{len(grounded.feet)} columns stand on parts, as supports.grounding allows",)
    return _Standing(edges, grounded.feet, connected | grounded.served, notes if len(grounded.feet) else ())


def _joined(laid: _Laid, standing: _Standing, wishes: Wishes) -> _Standing:
    """Brace slender columns, when asked to."""
    if wishes.slender is None:
        return standing
    joined = join_columns(laid.frame, laid.voxels, standing.edges, wishes.slender)
    note = f"{joined.braced} slender columns are braced by struts, {joined.alone} stand too far from others"
    edges = SupportEdges.concatenate([standing.edges, joined.edges]).merged()
    return standing._replace(edges=edges, notes=(*standing.notes, note))


def _layout(
    parts: Sequence[PlacedPart],
    needs: _Needs,
    laid: _Laid,
    standing: _Standing,
    reasons: Sequence[str],
    told: Sequence[str],
) -> SupportLayout:
    """Gather everything, with the groups that the supports form."""
    edges, red, connected = standing.edges, laid.red, standing.connected
    red_group, edge_group, group_parts = groups_of(edges, red, connected, len(parts))
    shared = [", ".join(parts[part].label for part in group) for group in group_parts if len(group) > 1]
    return SupportLayout(
        frame=laid.frame,
        voxels=laid.voxels,
        meshes=needs.meshes,
        overhangs=needs.overhangs,
        red=red.square,
        red_part=red.part,
        red_region=red.region,
        red_rise=red.rise,
        connected=connected,
        reasons=tuple("" if done else why for done, why in zip(connected.tolist(), reasons, strict=True)),
        feet=standing.feet,
        edges=replace(edges, group=edge_group),
        red_group=red_group,
        group_parts=group_parts,
        notes=(*told, *standing.notes),
        shared=tuple(f"share supports: {names}" for names in shared),
    )
