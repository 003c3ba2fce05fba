"""What the host asks a cell emitter for, and whether the answer fits the question."""

import numpy as np

from amprep.arrays import Ints
from amprep.model import CellRequest, Mesh, Role
from amprep.supports.layout import SupportLayout


def make_request(
    layout: SupportLayout,
    parts: tuple[Mesh, ...],
    *,
    overlap: float,
    allow_surface: bool,
    extend: bool,
    beams: bool | None = None,
) -> CellRequest:
    """Return a request for every edge of the layout, and with `extend` for the voxels above red squares.

    A connector gets one voxel more than its red square's run, for the overlap.
    """
    own = layout.edges
    roles = np.where(own.plane == 1, Role.FOOT, Role.TRUNK)
    edges = np.column_stack([own.plane, own.y, own.x, own.flow, own.group, own.direction, roles]).astype(
        np.int32
    )
    if extend:
        edges = np.vstack([edges, _above_red(layout)])
    plane, y, x, load, group, direction, role = edges.T
    return CellRequest(
        layout.frame,
        plane,
        y,
        x,
        direction,
        role,
        load,
        group,
        parts,
        overlap=overlap,
        allow_surface=allow_surface,
        beams=beams,
    )


def _above_red(layout: SupportLayout) -> Ints:
    """Connector edges: the voxels of each connected red square's run from below, and one above it."""
    red = np.flatnonzero(layout.connected)
    voxels = layout.red_rise[red] + 1
    up = np.arange(int(voxels.sum())) - np.repeat(np.cumsum(voxels) - voxels, voxels) + 1
    plane, y, x = np.repeat(layout.red[red], voxels, axis=0).T
    group = np.repeat(layout.red_group[red], voxels)
    rest = np.zeros_like(plane)
    return np.column_stack([plane + up, y, x, rest + 1, group, rest, rest + Role.CONNECTOR]).astype(np.int32)
