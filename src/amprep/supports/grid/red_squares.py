"""Red squares: where the columns of needy occupied voxels have a free voxel below (thesis 3.2)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bytes, Ints
from amprep.geometry.voxels.voxelise import UNMARKED
from amprep.model.supports import Voxel
from amprep.supports.grid.voxel_states import PartVoxels


class RedSquares(NamedTuple):
    """Red squares of a build: ``(m, 3)`` plane, y, x; part, region, and voxels the connector may pass."""

    square: Ints
    part: Ints
    region: Ints
    rise: Ints


def red_squares(voxels: Bytes, meeting: Bytes, parts: Sequence[PartVoxels]) -> RedSquares:
    """Return the red squares of all parts, sorted by part, plane, y, x.

    A run is a contiguous column of occupied voxels that hold needed geometry of one part. Its bottom square is
    red when the voxel below is white, or when it lies on the plate. The rise counts the run's voxels up to the
    first that is closed, or above the lowest one that another part meets too.
    """
    found = [_of_part(voxels, meeting, part, number) for number, part in enumerate(parts)]
    empty = RedSquares(np.empty((0, 3), np.int32), *(np.empty(0, np.int32) for _ in range(3)))
    return RedSquares(*(np.concatenate(each) for each in zip(empty, *found, strict=True)))


def _of_part(voxels: Bytes, meeting: Bytes, part: PartVoxels, number: int) -> RedSquares:
    k, y, x = part.window.slices
    own = voxels[k, y, x] == Voxel.OCCUPIED
    holds = (part.region != UNMARKED) & own
    rise = holds.astype(np.int32)
    region = np.where(holds, part.region, UNMARKED)
    alone = meeting[k, y, x] <= 1
    for plane in range(len(holds) - 2, -1, -1):
        above = holds[plane] & holds[plane + 1] & alone[plane + 1]
        rise[plane] += np.where(above, rise[plane + 1], 0)
        np.minimum(region[plane], region[plane + 1], out=region[plane], where=above)
    bottom = holds.copy()
    bottom[1:] &= ~holds[:-1]
    first = part.window.first[0]
    if first > 0:
        bottom[:1] &= voxels[first - 1, y, x] == Voxel.FREE
    bottom[1:] &= voxels[k, y, x][:-1] == Voxel.FREE
    square = np.argwhere(bottom)
    at = tuple(square.T)
    count = len(square)
    return RedSquares(
        (square + part.window.first).astype(np.int32), np.full(count, number, np.int32), region[at], rise[at]
    )


def close_gap(
    voxels: Bytes,
    parts: Sequence[PartVoxels],
    red: RedSquares,
    *,
    gap: float,
    step: float,
    overhang_angle_deg: float,
) -> None:
    """Close the free voxels nearer than `gap` mm to a part sideways; `voxels` is modified in place.

    Below a red square voxels stay open down to where an overhang as steep as the threshold has left the gap:
    ``gap * tan(overhang angle)``, in whole voxels and one more.
    """
    near = np.zeros(voxels.shape, np.bool_)
    for part in parts:
        if part.near is not None:
            near[part.window.slices] |= part.near
    leaving = np.ceil(gap * np.tan(np.radians(min(overhang_angle_deg, 80.0))) / step) + 1
    deep = int(min(leaving, len(voxels)))
    plane, y, x = red.square.T
    for down in range(1, deep + 1):
        reached = plane >= down
        near[plane[reached] - down, y[reached], x[reached]] = False
    voxels[near & (voxels == Voxel.FREE)] = Voxel.CLOSED
