"""Plans the supports of a build: needs, grid, red squares, routing, groups (thesis 3.2)."""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np

from amprep.checks.needs import needs_of
from amprep.model.arrays import Bools, Bytes, Ints
from amprep.model.build import Grounding, PlacedPart
from amprep.model.control import Report, Stop
from amprep.model.space import BuildVolume
from amprep.model.supports import Escalation
from amprep.pipeline.support_grid import MEMORY_MB, choose_pitch, coloured, cubes_of, frame_of
from amprep.pipeline.support_grounding import stand_on_parts
from amprep.pipeline.support_joining import join_columns
from amprep.pipeline.support_layout import SupportLayout
from amprep.pipeline.support_red import RedSquares, close_gap, red_squares
from amprep.pipeline.support_routing import (
    Network,
    Route,
    Rules,
    components,
    merge_edges,
    route_apart,
    route_together,
)

__all__ = ["Route", "SupportLayout", "choose_pitch", "plan_supports"]


def plan_supports(
    parts: Sequence[PlacedPart],
    space: BuildVolume,
    *,
    route: Route,
    overhang_angle_deg: float = 45.0,
    strut_angle_deg: float = 45.0,
    pitch: float | None = None,
    gap: float = 0.0,
    grounding: Grounding = "plate",
    memory_mb: int = MEMORY_MB,
    edge_capacity: int = 0,
    node_capacity: int = 0,
    costs: tuple[int, int] = (1, 2),
    material: tuple[float, float] = (1.0, 1.0),
    escalation: Escalation = "none",
    load_area: float = 0.0,
    load_height: float = 0.0,
    least_area: float = 0.5,
    least_length: float = 0.5,
    share_between_parts: Literal["avoid", "allow"] = "avoid",
    slender: float | None = None,
    only: Callable[[Bytes, RedSquares], Bools] | None = None,
    stop: Stop,
    report: Report,
) -> SupportLayout:
    """Find what needs support, lay the grid, and route every red square to the plate (thesis 3.1 and 3.2).

    Parameters
    ----------
    route
        The chosen router; it may be called once for each part.
    pitch
        mm; None chooses one by `choose_pitch`.
    gap
        Least distance between supports and parts sideways, mm; 0 for none.
    grounding
        ``plate``, or ``anywhere``: what finds no way to the plate may stand on the part it belongs to.
    memory_mb
        What the grid may take.
    load_area, load_height
        mm2 of overhang on one edge, and mm up to which that holds (`Rules`); 0 for no limit.
    share_between_parts
        ``avoid``: part by part, sharing only where a red square would otherwise stay unconnected; ``allow``:
        one network.
    slender
        Columns higher than so many times their width are joined to others; None joins none.
    only
        Tells from the cubes which red squares to connect; the others are left out. None connects all.

    Raises
    ------
    JobError
        When the grid takes more memory than allowed.
    PluginError
        When the router returns a plan that breaks its promise.
    """
    limits = {
        "overhang_angle_deg": overhang_angle_deg,
        "least_area": least_area,
        "least_length": least_length,
    }
    found = [needs_of(placed, **limits) for placed in parts]
    meshes, needs = [each.mesh for each in found], [each.overhangs for each in found]
    report(0.05, "overhangs found")
    pitch = pitch or choose_pitch(parts, space, strut_angle_deg, memory_mb)
    frame = frame_of(meshes, needs, space, pitch=pitch, strut_angle_deg=strut_angle_deg, memory_mb=memory_mb)
    blocks = [
        cubes_of(mesh, own, frame, gap=gap, solid=placed.part.is_solid)
        for placed, mesh, own in zip(parts, meshes, needs, strict=True)
    ]
    cubes, meeting = coloured(frame, space, blocks)
    red = red_squares(cubes, meeting, blocks)
    if only is not None:
        keep = only(cubes, red)
        red = RedSquares(*(each[keep] for each in red))
    if gap > 0:
        close_gap(cubes, blocks, red, gap=gap, step=frame.step, overhang_angle_deg=overhang_angle_deg)
    report(0.15, "grid laid")
    rules = Rules(edge_capacity, node_capacity, costs, material, escalation, load_area, load_height)
    network = Network(frame, cubes, red, rules, route, stop)

    def routing(share: float, words: str) -> None:
        report(0.15 + 0.85 * share, words)

    routed = (route_apart if share_between_parts == "avoid" else route_together)(network, routing)
    connected = np.array([reason == "" for reason in routed.reasons], np.bool_)
    grounded = stand_on_parts(
        cubes, meeting, blocks, red, ~connected & (grounding == "anywhere"), routed.edges
    )
    edges = merge_edges(np.concatenate([routed.edges, grounded.edges]))
    connected |= grounded.served
    notes = [words if part is None else f"{parts[part].label}: {words}" for part, words in network.notes]
    if len(grounded.feet):
        notes.append(f"{len(grounded.feet)} columns stand on parts, as supports.grounding allows")
    if slender is not None:
        joined = join_columns(frame, cubes, edges, slender)
        edges = merge_edges(np.concatenate([edges, joined.edges]))
        notes.append(
            f"{joined.braced} slender columns are braced by struts, {joined.alone} stand too far from others"
        )
    group, edge_group, group_parts = _groups(edges, red, connected, len(parts))
    shared = [group for group in group_parts if len(group) > 1]
    notes += ["share supports: " + ", ".join(parts[part].label for part in group) for group in shared]
    return SupportLayout(
        frame=frame,
        cubes=cubes,
        meshes=tuple(meshes),
        overhangs=tuple(needs),
        red=red.square,
        red_part=red.part,
        red_region=red.region,
        red_rise=red.rise,
        connected=connected,
        reasons=tuple(
            "" if done else reason for done, reason in zip(connected.tolist(), routed.reasons, strict=True)
        ),
        feet=grounded.feet,
        plane=edges[:, 0],
        y=edges[:, 1],
        x=edges[:, 2],
        direction=edges[:, 3].astype(np.uint8),
        flow=edges[:, 4],
        capacity=edges[:, 5],
        edge_part=edges[:, 6],
        red_group=group,
        edge_group=edge_group,
        group_parts=group_parts,
        notes=tuple(notes),
    )


def _groups(
    edges: Ints, red: RedSquares, connected: Bools, count: int
) -> tuple[Ints, Ints, tuple[tuple[int, ...], ...]]:
    """Make one group per part, and one of all parts whose supports meet in a square."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, of_red = components(edges, red.square[connected])
    part = red.part[connected]
    owner = np.full(int(of_red.max(initial=-1)) + 1, -1)
    owner[of_red[::-1]] = part[::-1]
    graph = coo_array((np.ones(len(part)), (part, owner[of_red])), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    used, number = np.unique(label[part], return_inverse=True)
    group = np.full(len(red.part), -1, np.int32)
    group[connected] = number
    edge_group = np.searchsorted(used, label[edges[:, 6]]).astype(np.int32)
    held = [sorted(set(part[number == i].tolist())) for i in range(len(used))]
    return group, edge_group, tuple(tuple(each) for each in held)
