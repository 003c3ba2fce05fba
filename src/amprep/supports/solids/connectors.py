"""ConnectorColumns above the red squares of a layout, and the pieces of the parts' surfaces in them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, MeshArrays
from amprep.geometry.connectors.columns import (
    ConnectorColumns,
    Patches,
    clip_to_columns,
    held_corners,
    join_patches,
)
from amprep.geometry.connectors.connect import connect
from amprep.model import Mesh
from amprep.supports.layout import SupportLayout

WIDEST_BAND = 1.0
"""mm; how wide the level band below a knife edge and the square below a tip may get."""


class ColumnSurfaces(NamedTuple):
    """What connectors have to go by.

    Attributes
    ----------
    columns
        One per red square of the layout.
    held, surface
        What is to be held, and all that looks down, in the columns of connected red squares.
    own
        ``(n,)`` whether each patch of `surface` belongs to the part that its column holds.
    """

    columns: ConnectorColumns
    held: Patches
    surface: Patches
    own: Bools


def find_column_surfaces(layout: SupportLayout, meshes: Sequence[Mesh]) -> ColumnSurfaces:
    """Cut the overhangs and all surfaces of the parts to the columns above connected red squares."""
    columns = _columns(layout)
    width = min(layout.frame.pitch, WIDEST_BAND)
    held, surface, own = [], [], []
    first = 0
    for part, (mesh, needs) in enumerate(zip(meshes, layout.overhangs, strict=True)):
        faces, edges, tips = (np.asarray(each, np.int64) for each in (needs.faces, needs.edges, needs.tips))
        corners = held_corners(mesh.vertices, mesh.triangles, faces, edges, tips, width=width)
        added = -1 - np.arange(len(corners) - len(needs.faces))
        mine = layout.red_part == part
        number = np.concatenate([first + needs.faces, added]).astype(np.int64)
        held.append(clip_to_columns(columns, corners, number, layout.connected & mine))
        number = first + np.arange(len(mesh.triangles))
        surface.append(clip_to_columns(columns, mesh.vertices[mesh.triangles], number, layout.connected))
        first += len(mesh.triangles)
    count = len(layout.red)
    all_surface = join_patches(surface, count)
    ends = np.cumsum([len(mesh.triangles) for mesh in meshes])
    own = layout.red_part[all_surface.owner[:, 0]] == np.searchsorted(
        ends, all_surface.owner[:, 1], side="right"
    )
    return ColumnSurfaces(columns, join_patches(held, count), all_surface, own)


def _columns(layout: SupportLayout) -> ConnectorColumns:
    frame = layout.frame
    plane, y, x = layout.red.T.astype(np.int64)
    size = (frame.pitch, frame.pitch, frame.step)
    low = frame.origin + np.column_stack([x, y, plane]) * size
    high = frame.origin + np.column_stack([x + 1, y + 1, plane + layout.red_rise]) * size
    grid = np.array([frame.origin[0], frame.origin[1], frame.pitch])
    return ConnectorColumns(low, high, np.column_stack([y, x]), grid, frame.shape[1:])


_DOWN = np.array([1.0, 1.0, -1.0])


def make_feet(
    layout: SupportLayout, meshes: Sequence[Mesh], group: int, *, overlap: float, seat: float
) -> list[MeshArrays]:
    """Return closed meshes of the feet of a group, from `seat` mm above their squares to `overlap` in the part.

    The world is mirrored for this: what looks up looks down then, and is held as overhangs are.
    """
    own = layout.feet[np.isin(layout.feet[:, 3], layout.group_parts[group])]
    if not len(own):
        return []
    columns = _foot_columns(layout, own)
    patches = []
    for part in np.unique(own[:, 3]).tolist():
        corners = (meshes[part].vertices * _DOWN)[meshes[part].triangles[:, ::-1]]
        patches.append(clip_to_columns(columns, corners, np.arange(len(corners)), own[:, 3] == part))
    surface = join_patches(patches, len(own))
    base, lid = columns.lo[:, 2] - seat, columns.hi[:, 2] + layout.frame.step
    mine = np.ones(len(surface.owner), np.bool_)
    feet = connect(surface, surface, base=base, lid=lid, overlap=overlap, own=mine)
    return [(points * _DOWN, triangles[:, ::-1]) for points, triangles in feet]


def foot_boxes(layout: SupportLayout, group: int, overlap: float) -> tuple[Floats, Floats]:
    """Return the least and greatest corners ``(k, 3)`` mm of the boxes in which the feet of a group end."""
    own = layout.feet[np.isin(layout.feet[:, 3], layout.group_parts[group])]
    columns = _foot_columns(layout, own)
    lo, hi = columns.hi * _DOWN, columns.lo * _DOWN
    lo[:, :2], hi[:, :2] = columns.lo[:, :2], columns.hi[:, :2]
    return lo - (0.0, 0.0, overlap), hi


def _foot_columns(layout: SupportLayout, feet: np.ndarray) -> ConnectorColumns:
    """Return the mirrored spaces that the feet may pass."""
    frame = layout.frame
    plane, y, x, _, deep = feet.T.astype(np.int64)
    size = (frame.pitch, frame.pitch, frame.step)
    low = frame.origin + np.column_stack([x, y, -plane]) * size
    high = frame.origin + np.column_stack([x + 1, y + 1, deep - plane]) * size
    grid = np.array([frame.origin[0], frame.origin[1], frame.pitch])
    return ConnectorColumns(low, high, np.column_stack([y, x]), grid, frame.shape[1:])
