"""Make the request to the cell emitter from a support layout."""

import numpy as np

from amprep.model import CellRequest, Mesh, Role, SupportEdges
from amprep.supports.layout import SupportLayout


def make_request(
    layout: SupportLayout,
    parts: tuple[Mesh, ...],
    *,
    overlap: float,
    allow_surface: bool,
    extend: bool,
    beams: bool | None = None,
    least_wall: float = 0.0,
    leg_ratio: float = 0.0,
) -> CellRequest:
    """Return a request for every edge of the layout, and with `extend` for the voxels above red squares.

    A connector gets one voxel more than its red square's run, for the overlap.
    """
    edges, role = layout.edges, np.where(layout.edges.plane == 1, Role.FOOT, Role.TRUNK)
    if extend:
        above = _above_red(layout)
        edges = SupportEdges.concatenate([edges, above])
        role = np.concatenate([role, np.full(len(above), Role.CONNECTOR)])
    return CellRequest(
        layout.grid,
        edges,
        role,
        parts,
        overlap=overlap,
        allow_surface=allow_surface,
        beams=beams,
        least_wall=least_wall,
        leg_ratio=leg_ratio,
    )


def _above_red(layout: SupportLayout) -> SupportEdges:
    """Return connector edges for the voxels of each connected red square's rise, and for one voxel above it."""
    red = np.flatnonzero(layout.connected)
    voxels = layout.red.rise[red] + 1
    up = np.arange(int(voxels.sum())) - np.repeat(np.cumsum(voxels) - voxels, voxels) + 1
    plane, y, x = np.repeat(layout.red.square[red], voxels, axis=0).T
    one = np.ones_like(plane)
    return SupportEdges(
        plane + up,
        y,
        x,
        direction=0 * one,
        flow=one,
        capacity=one,
        part=np.repeat(layout.red.part[red], voxels),
        group=np.repeat(layout.red_group[red], voxels),
    )
