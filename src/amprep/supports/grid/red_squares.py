"""Red squares: where the columns of needy black cubes have a white cube below (thesis 3.2)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bytes, Ints
from amprep.geometry.voxels.voxelise import UNMARKED
from amprep.model.supports import Cube
from amprep.supports.grid.sizing import PartCubes


class RedSquares(NamedTuple):
    """Red squares of a build: ``(m, 3)`` plane, y, x; part, region, and cubes the connector may pass."""

    square: Ints
    part: Ints
    region: Ints
    rise: Ints


def red_squares(cubes: Bytes, meeting: Bytes, parts: Sequence[PartCubes]) -> RedSquares:
    """Return the red squares of all parts, sorted by part, plane, y, x.

    A run is a contiguous column of black cubes that hold needed geometry of one part. Its bottom square is
    red when the cube below is white, or when it lies on the plate. The rise counts the run's cubes up to the
    first that is closed, or above the lowest one that another part meets too.
    """
    found = [_of_part(cubes, meeting, part, number) for number, part in enumerate(parts)]
    empty = RedSquares(np.empty((0, 3), np.int32), *(np.empty(0, np.int32) for _ in range(3)))
    return RedSquares(*(np.concatenate(each) for each in zip(empty, *found, strict=True)))


def _of_part(cubes: Bytes, meeting: Bytes, part: PartCubes, number: int) -> RedSquares:
    k, y, x = part.window.slices
    own = cubes[k, y, x] == Cube.BLACK
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
        bottom[:1] &= cubes[first - 1, y, x] == Cube.WHITE
    bottom[1:] &= cubes[k, y, x][:-1] == Cube.WHITE
    square = np.argwhere(bottom)
    at = tuple(square.T)
    count = len(square)
    return RedSquares(
        (square + part.window.first).astype(np.int32), np.full(count, number, np.int32), region[at], rise[at]
    )


def close_gap(
    cubes: Bytes,
    parts: Sequence[PartCubes],
    red: RedSquares,
    *,
    gap: float,
    step: float,
    overhang_angle_deg: float,
) -> None:
    """Close the white cubes nearer than `gap` mm to a part sideways; `cubes` is modified in place.

    Below a red square cubes stay open down to where an overhang as steep as the threshold has left the gap:
    ``gap * tan(overhang angle)``, in whole cubes and one more.
    """
    near = np.zeros(cubes.shape, np.bool_)
    for part in parts:
        if part.near is not None:
            near[part.window.slices] |= part.near
    leaving = np.ceil(gap * np.tan(np.radians(min(overhang_angle_deg, 80.0))) / step) + 1
    deep = int(min(leaving, len(cubes)))
    plane, y, x = red.square.T
    for down in range(1, deep + 1):
        reached = plane >= down
        near[plane[reached] - down, y[reached], x[reached]] = False
    cubes[near & (cubes == Cube.WHITE)] = Cube.CLOSED
