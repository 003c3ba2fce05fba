"""Lay the grid of a build: the state of each voxel, and the red squares (thesis 3.2)."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Bytes, Ints
from amprep.geometry.voxels.grid import Grid, VoxelBlock
from amprep.geometry.voxels.voxelise import UNMARKED, holding_voxels, met_voxels, near_voxels
from amprep.model.build import PlacedPart
from amprep.model.build_volume import BuildVolume
from amprep.model.supports import Voxel
from amprep.overhangs.of_part import PartOverhangs
from amprep.supports.grid.sizing import choose_pitch, lay_grid, whole_count
from amprep.supports.rules import PlanningRules


class RedSquares(NamedTuple):
    """Red squares of all parts, sorted by part, plane, y, x; a square occurs once for each part it supports.

    Attributes
    ----------
    square
        ``(m, 3)`` int32 plane, y, x.
    part, region
        ``(m,)`` int32: placed part, and its overhang region; of several regions above the square the first.
    rise
        ``(m,)`` int32: number of occupied voxels, from the red square upwards, that its connector may pass. They
        contain overhanging geometry of the part without interruption.
    """

    square: Ints
    part: Ints
    region: Ints
    rise: Ints


class PartVoxels(NamedTuple):
    """The voxels of one part, as arrays over a block of the grid.

    Attributes
    ----------
    block
        Position and shape of the block.
    occupied
        ``block.shape`` bool: voxels that the part meets.
    region
        ``block.shape`` int32: overhang region that an occupied voxel contains, else `UNMARKED`.
    near
        ``block.shape`` bool: voxels nearer to the part than the gap; None without a gap.
    """

    block: VoxelBlock
    occupied: Bools
    region: Ints
    near: Bools | None


class SupportGrid(NamedTuple):
    """The grid of a build with the states of its voxels.

    Attributes
    ----------
    voxels
        ``(nz, ny, nx)`` uint8, values of `Voxel`.
    part_count
        ``(nz, ny, nx)`` uint8: number of parts that meet each voxel, at most 2.
    parts
        The voxels of each placed part.
    red
        Red squares to connect.
    """

    grid: Grid
    voxels: Bytes
    part_count: Bytes
    parts: tuple[PartVoxels, ...]
    red: RedSquares


Choose = Callable[[Bytes, RedSquares], Bools]
"""Returns, from the voxels and all red squares, which red squares to connect."""

CloseVoxels = Callable[[Bytes, Grid], None]
"""Closes voxels of a grid, in place."""


def make_grid(
    placed: Sequence[PlacedPart],
    overhangs: Sequence[PartOverhangs],
    space: BuildVolume,
    rules: PlanningRules,
    choose: Choose | None = None,
    close: CloseVoxels | None = None,
) -> SupportGrid:
    """Lay the grid around the parts, find the state of each voxel and the red squares.

    Parameters
    ----------
    placed, overhangs
        The parts, and the overhangs of each.
    space
        The build volume.
    rules
        Pitch, memory, strut angle, overhang angle and gap.
    choose
        Chooses the red squares to connect; None chooses all.
    close
        Closes the voxels that the supports of earlier passes take; None closes none.

    Raises
    ------
    JobError
        If the grid takes more memory than `rules.memory_mb`.
    """
    grid = lay_grid(overhangs, space, choose_pitch(placed, space, rules), rules)
    parts = tuple(
        _voxels_of(own, grid, gap=rules.gap_mm, solid=each.part.is_solid)
        for each, own in zip(placed, overhangs, strict=True)
    )
    voxels, part_count = voxel_states(grid, space, parts)
    if close is not None:
        close(voxels, grid)
    red = find_red_squares(voxels, part_count, parts)
    if choose is not None:
        chosen = choose(voxels, red)
        red = RedSquares(*(each[chosen] for each in red))
    laid = SupportGrid(grid, voxels, part_count, parts, red)
    if rules.gap_mm > 0:
        _close_near_voxels(laid, rules.gap_mm, rules.overhang_angle_deg)
    return laid


def _voxels_of(own: PartOverhangs, grid: Grid, *, gap: float, solid: bool) -> PartVoxels:
    """Voxelise one part."""
    lo, hi = own.mesh.bounds
    block = grid.block(lo, hi, margin=gap)
    occupied = met_voxels(block, own.mesh.vertices, own.mesh.triangles, solid=solid)
    region = np.full(block.shape, UNMARKED, np.int32)
    if own.overhangs.regions:
        region = holding_voxels(block, own.mesh.vertices, own.mesh.triangles, own.overhangs)
        region[~occupied] = UNMARKED
    near = near_voxels(block, own.mesh.vertices, own.mesh.triangles, gap) if gap > 0 else None
    return PartVoxels(block, occupied, region, near)


def voxel_states(grid: Grid, space: BuildVolume, parts: Sequence[PartVoxels]) -> tuple[Bytes, Bytes]:
    """Return the state of all voxels (values of `Voxel`) and the number of parts that meet each, at most 2."""
    part_count = np.zeros(grid.shape, np.uint8)
    for part in parts:
        block = part_count[part.block.slices]
        np.minimum(block + part.occupied, 2, out=block, casting="unsafe")
    voxels = np.where(part_count > 0, np.uint8(Voxel.OCCUPIED), np.uint8(Voxel.FREE))
    voxels[closed_voxels(grid, space)] = Voxel.CLOSED
    return voxels, part_count


def closed_voxels(grid: Grid, space: BuildVolume) -> Bools:
    """Tell which voxels are not entirely inside the build volume or meet a forbidden zone."""
    closed = np.zeros(grid.shape, np.bool_)
    x0, y0, _ = grid.origin
    _, ny, nx = grid.shape
    left, front = x0 + np.arange(nx) * grid.pitch, y0 + np.arange(ny) * grid.pitch
    outside_x = (left < -CONTACT_TOLERANCE) | (left + grid.pitch > space.size[0] + CONTACT_TOLERANCE)
    outside_y = (front < -CONTACT_TOLERANCE) | (front + grid.pitch > space.size[1] + CONTACT_TOLERANCE)
    closed |= outside_y[:, None] | outside_x
    if space.shape == "cylinder":
        radius = space.size[0] / 2
        far_x = np.maximum(np.abs(left - radius), np.abs(left + grid.pitch - radius))
        far_y = np.maximum(np.abs(front - radius), np.abs(front + grid.pitch - radius))
        closed |= np.hypot(far_y[:, None], far_x) > radius + CONTACT_TOLERANCE
    size = np.array([grid.pitch, grid.pitch, grid.step])
    for lo, hi in zip(space.zone_lo, space.zone_hi, strict=True):
        first = np.floor((lo + CONTACT_TOLERANCE - grid.origin) / size).astype(int)
        last = np.ceil((hi - CONTACT_TOLERANCE - grid.origin) / size).astype(int)
        x, y, z = (slice(max(a, 0), max(b, 0)) for a, b in zip(first, last, strict=True))
        closed[z, y, x] = True
    closed[whole_count((space.size[2] + CONTACT_TOLERANCE) / grid.step) :] = True
    return closed


def find_red_squares(voxels: Bytes, part_count: Bytes, parts: Sequence[PartVoxels]) -> RedSquares:
    """Return the red squares of all parts.

    A run is a maximal vertical sequence of occupied voxels that contain overhanging geometry of one part. The
    bottom square of a run is red if the voxel below it is free, or if it is on the plate. The rise counts the
    voxels of the run; it ends below the first voxel above the red square that another part meets too.
    """
    found = [_red_squares_of(voxels, part_count, part, number) for number, part in enumerate(parts)]
    empty = RedSquares(np.empty((0, 3), np.int32), *(np.empty(0, np.int32) for _ in range(3)))
    return RedSquares(*(np.concatenate(each) for each in zip(empty, *found, strict=True)))


def _red_squares_of(voxels: Bytes, part_count: Bytes, part: PartVoxels, number: int) -> RedSquares:
    k, y, x = part.block.slices
    holds = (part.region != UNMARKED) & (voxels[k, y, x] == Voxel.OCCUPIED)
    rise = holds.astype(np.int32)
    region = np.where(holds, part.region, UNMARKED)
    alone = part_count[k, y, x] <= 1
    for plane in range(len(holds) - 2, -1, -1):
        above = holds[plane] & holds[plane + 1] & alone[plane + 1]
        rise[plane] += np.where(above, rise[plane + 1], 0)
        np.minimum(region[plane], region[plane + 1], out=region[plane], where=above)
    bottom = holds.copy()
    bottom[1:] &= ~holds[:-1]
    first = part.block.first[0]
    if first > 0:
        bottom[:1] &= voxels[first - 1, y, x] == Voxel.FREE
    bottom[1:] &= voxels[k, y, x][:-1] == Voxel.FREE
    square = np.argwhere(bottom)
    at = tuple(square.T)
    part_numbers = np.full(len(square), number, np.int32)
    return RedSquares((square + part.block.first).astype(np.int32), part_numbers, region[at], rise[at])


def _close_near_voxels(laid: SupportGrid, gap: float, overhang_angle_deg: float) -> None:
    """Close the free voxels nearer to a part than `gap` (mm, horizontally); ``laid.voxels`` is modified in place.

    Below each red square voxels stay free down to the height at which an overhang at the threshold angle is
    farther away than the gap: ``gap * tan(overhang angle)``, rounded up to voxels, and one voxel more.
    """
    near = np.zeros(laid.voxels.shape, np.bool_)
    for part in laid.parts:
        if part.near is not None:
            near[part.block.slices] |= part.near
    depth = np.ceil(gap * np.tan(np.radians(min(overhang_angle_deg, 80.0))) / laid.grid.step) + 1
    plane, y, x = laid.red.square.T
    for down in range(1, int(min(depth, len(laid.voxels))) + 1):
        reached = plane >= down
        near[plane[reached] - down, y[reached], x[reached]] = False
    laid.voxels[near & (laid.voxels == Voxel.FREE)] = Voxel.CLOSED
