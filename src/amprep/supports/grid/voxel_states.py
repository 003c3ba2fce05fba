"""The state of each voxel: black, closed or white."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Bytes, Ints
from amprep.geometry.overhangs.regions import Overhangs
from amprep.geometry.voxels.grid import Grid, Window
from amprep.geometry.voxels.voxelise import UNMARKED, holding_voxels, met_voxels, near_voxels
from amprep.model.build_volume import BuildVolume
from amprep.model.mesh import Mesh
from amprep.model.supports import Voxel
from amprep.supports.grid.sizing import whole_count


def closed_voxels(frame: Grid, space: BuildVolume) -> Bools:
    """Tell which voxels are not wholly inside the build volume or meet a forbidden zone."""
    closed = np.zeros(frame.shape, np.bool_)
    x0, y0, _ = frame.origin
    _, ny, nx = frame.shape
    left, front = x0 + np.arange(nx) * frame.pitch, y0 + np.arange(ny) * frame.pitch
    outside_x = (left < -CONTACT_TOLERANCE) | (left + frame.pitch > space.size[0] + CONTACT_TOLERANCE)
    outside_y = (front < -CONTACT_TOLERANCE) | (front + frame.pitch > space.size[1] + CONTACT_TOLERANCE)
    closed |= outside_y[:, None] | outside_x
    if space.shape == "cylinder":
        radius = space.size[0] / 2
        far_x = np.maximum(np.abs(left - radius), np.abs(left + frame.pitch - radius))
        far_y = np.maximum(np.abs(front - radius), np.abs(front + frame.pitch - radius))
        closed |= np.hypot(far_y[:, None], far_x) > radius + CONTACT_TOLERANCE
    size = np.array([frame.pitch, frame.pitch, frame.step])
    for lo, hi in zip(space.zone_lo, space.zone_hi, strict=True):
        first = np.floor((lo + CONTACT_TOLERANCE - frame.origin) / size).astype(int)
        last = np.ceil((hi - CONTACT_TOLERANCE - frame.origin) / size).astype(int)
        x, y, z = (slice(max(a, 0), max(b, 0)) for a, b in zip(first, last, strict=True))
        closed[z, y, x] = True
    closed[whole_count((space.size[2] + CONTACT_TOLERANCE) / frame.step) :] = True
    return closed


class PartVoxels(NamedTuple):
    """One part's voxels in its window: those it meets, the region each needy voxel holds, those it is near."""

    window: Window
    black: Bools
    region: Ints
    near: Bools | None


def voxels_of(mesh: Mesh, overhangs: Overhangs, frame: Grid, *, gap: float, solid: bool) -> PartVoxels:
    """Voxelise one part; `near` only when `gap` (mm) is not 0."""
    lo, hi = mesh.bounds
    window = frame.window(lo, hi, margin=gap)
    black = met_voxels(window, mesh.vertices, mesh.triangles, solid=solid)
    region = np.full(window.shape, UNMARKED, np.int32)
    if overhangs.regions:
        region = holding_voxels(window, mesh.vertices, mesh.triangles, overhangs)
        region[~black] = UNMARKED
    near = near_voxels(window, mesh.vertices, mesh.triangles, gap) if gap > 0 else None
    return PartVoxels(window, black, region, near)


def coloured(frame: Grid, space: BuildVolume, parts: Sequence[PartVoxels]) -> tuple[Bytes, Bytes]:
    """Return all voxels (values of `Voxel`) and how many parts meet each, at most 2."""
    meeting = np.zeros(frame.shape, np.uint8)
    for part in parts:
        block = meeting[part.window.slices]
        np.minimum(block + part.black, 2, out=block, casting="unsafe")
    voxels = np.where(meeting > 0, np.uint8(Voxel.OCCUPIED), np.uint8(Voxel.FREE))
    voxels[closed_voxels(frame, space)] = Voxel.CLOSED
    return voxels, meeting
