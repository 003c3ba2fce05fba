"""Find the surfaces of parts in the columns above red squares, and build the feet of supports on parts."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints, MeshArrays
from amprep.geometry.connectors.columns import (
    ConnectorColumns,
    clip_to_columns,
    join_patches,
    supported_triangles,
)
from amprep.geometry.connectors.connect import connect
from amprep.geometry.voxels.grid import Grid
from amprep.kernels.meshes.patches import Patches
from amprep.supports.layout import SupportLayout

WIDEST_BAND = 1.0
"""Largest width (mm) of the level band below a knife edge and of the level square below a tip."""

_MIRROR = np.array([1.0, 1.0, -1.0])


class ColumnSurfaces(NamedTuple):
    """Surfaces of the parts in the columns above connected red squares.

    Attributes
    ----------
    columns
        One column per red square of the layout.
    supported
        Overhangs of the part that each column supports.
    surface
        All faces of all parts that point down.
    own
        ``(n,)`` whether each patch of `surface` belongs to the part that its column supports.
    """

    columns: ConnectorColumns
    supported: Patches
    surface: Patches
    own: Bools


def find_column_surfaces(layout: SupportLayout) -> ColumnSurfaces:
    """Clip the overhangs and all surfaces of the parts to the columns above connected red squares."""
    columns = _columns_over(layout.red.square, layout.red.rise, layout.grid)
    width = min(layout.grid.pitch, WIDEST_BAND)
    supported, surface = [], []
    first = 0
    for part, (mesh, overhangs) in enumerate(layout.overhangs):
        faces = np.concatenate([overhangs.faces, overhangs.beside]).astype(np.int64)
        features = (faces, *(np.asarray(each, np.int64) for each in (overhangs.edges, overhangs.tips)))
        corners = supported_triangles(mesh.vertices, mesh.triangles, *features, width=width)
        bands = -1 - np.arange(len(corners) - len(faces))
        number = np.concatenate([first + faces, bands]).astype(np.int64)
        own_columns = layout.connected & (layout.red.part == part)
        supported.append(clip_to_columns(columns, corners, number, own_columns))
        number = first + np.arange(len(mesh.triangles))
        surface.append(clip_to_columns(columns, mesh.vertices[mesh.triangles], number, layout.connected))
        first += len(mesh.triangles)
    count = len(layout.red.square)
    all_surface = join_patches(surface, count)
    ends = np.cumsum([len(mesh.triangles) for mesh, _ in layout.overhangs])
    part_of = np.searchsorted(ends, all_surface.owner[:, 1], side="right")
    own = layout.red.part[all_surface.owner[:, 0]] == part_of
    return ColumnSurfaces(columns, join_patches(supported, count), all_surface, own)


def _columns_over(square: Ints, layers: Ints, grid: Grid) -> ConnectorColumns:
    """Return the columns over squares ``(m, 3)`` plane, y, x, each `layers` ``(m,)`` high."""
    plane, y, x = square.T.astype(np.int64)
    size = (grid.pitch, grid.pitch, grid.step)
    low = grid.origin + np.column_stack([x, y, plane]) * size
    high = grid.origin + np.column_stack([x + 1, y + 1, plane + layers]) * size
    axes = np.array([grid.origin[0], grid.origin[1], grid.pitch])
    return ConnectorColumns(low, high, np.column_stack([y, x]), axes, grid.shape[1:])


def make_feet(layout: SupportLayout, group: int, *, overlap: float, seat: float) -> list[MeshArrays]:
    """Return closed meshes of the feet of a group on parts.

    Everything is mirrored at z = 0: then upper faces of parts point down, and feet are built like connectors.

    Parameters
    ----------
    layout
        Layout with the feet.
    group
        Number of the support group.
    overlap
        Depth (mm) to which feet enter the parts.
    seat
        Height (mm) above their squares at which feet begin.
    """
    own = _feet_of(layout, group)
    if not len(own):
        return []
    columns = _mirrored_columns(layout, own)
    patches = []
    for part in np.unique(own[:, 3]).tolist():
        mesh = layout.overhangs[part].mesh
        corners = (mesh.vertices * _MIRROR)[mesh.triangles[:, ::-1]]
        patches.append(clip_to_columns(columns, corners, np.arange(len(corners)), own[:, 3] == part))
    surface = join_patches(patches, len(own))
    base, top = columns.lo[:, 2] - seat, columns.hi[:, 2] + layout.grid.step
    every = np.ones(len(surface.owner), np.bool_)
    feet = connect(surface, surface, square=columns.square, base=base, top=top, overlap=overlap, own=every)
    return [(points * _MIRROR, triangles[:, ::-1]) for points, triangles in feet]


def foot_boxes(layout: SupportLayout, group: int, overlap: float) -> tuple[Floats, Floats]:
    """Return the least and greatest corners ``(k, 3)`` mm of the boxes in which the feet of a group end."""
    columns = _mirrored_columns(layout, _feet_of(layout, group))
    lo, hi = columns.hi * _MIRROR, columns.lo * _MIRROR
    lo[:, :2], hi[:, :2] = columns.lo[:, :2], columns.hi[:, :2]
    return lo - (0.0, 0.0, overlap), hi


def _feet_of(layout: SupportLayout, group: int) -> Int64s:
    """Return the feet of a group as rows plane, y, x, part, depth."""
    return layout.feet[np.isin(layout.feet[:, 3], layout.group_parts[group])].astype(np.int64)


def _mirrored_columns(layout: SupportLayout, feet: Int64s) -> ConnectorColumns:
    """Return the mirrored columns that the feet may fill."""
    return _columns_over(feet[:, :3] * (-1, 1, 1), feet[:, 4], layout.grid)
