"""Feet of supports that stand on a part: connectors upside down, from green squares to the surface below."""

from collections.abc import Sequence

import numpy as np

from amprep.geometry.cell_tiling import Arrays
from amprep.geometry.connectors import Columns, clip_into, connect, join_patches
from amprep.model import Mesh
from amprep.model.arrays import Floats
from amprep.pipeline.support_layout import SupportLayout

_DOWN = np.array([1.0, 1.0, -1.0])


def make_feet(
    layout: SupportLayout, meshes: Sequence[Mesh], group: int, *, overlap: float, seat: float
) -> list[Arrays]:
    """Return closed meshes of the feet of a group, from `seat` mm above their squares to `overlap` in the part.

    The world is mirrored for this: what looks up looks down then, and is held as overhangs are.
    """
    own = layout.feet[np.isin(layout.feet[:, 3], layout.group_parts[group])]
    if not len(own):
        return []
    columns = _columns(layout, own)
    patches = []
    for part in np.unique(own[:, 3]).tolist():
        corners = (meshes[part].vertices * _DOWN)[meshes[part].triangles[:, ::-1]]
        patches.append(clip_into(columns, corners, np.arange(len(corners)), own[:, 3] == part))
    surface = join_patches(patches, len(own))
    base, lid = columns.lo[:, 2] - seat, columns.hi[:, 2] + layout.frame.step
    mine = np.ones(len(surface.owner), np.bool_)
    feet = connect(surface, surface, base=base, lid=lid, overlap=overlap, own=mine)
    return [(points * _DOWN, triangles[:, ::-1]) for points, triangles in feet]


def foot_boxes(layout: SupportLayout, group: int, overlap: float) -> tuple[Floats, Floats]:
    """Return the least and greatest corners ``(k, 3)`` mm of the boxes in which the feet of a group end."""
    own = layout.feet[np.isin(layout.feet[:, 3], layout.group_parts[group])]
    columns = _columns(layout, own)
    lo, hi = columns.hi * _DOWN, columns.lo * _DOWN
    lo[:, :2], hi[:, :2] = columns.lo[:, :2], columns.hi[:, :2]
    return lo - (0.0, 0.0, overlap), hi


def _columns(layout: SupportLayout, feet: np.ndarray) -> Columns:
    """Return the mirrored spaces that the feet may pass."""
    frame = layout.frame
    plane, y, x, _, deep = feet.T.astype(np.int64)
    size = (frame.pitch, frame.pitch, frame.step)
    low = frame.origin + np.column_stack([x, y, -plane]) * size
    high = frame.origin + np.column_stack([x + 1, y + 1, deep - plane]) * size
    grid = np.array([frame.origin[0], frame.origin[1], frame.pitch])
    return Columns(low, high, np.column_stack([y, x]), grid, frame.shape[1:])
