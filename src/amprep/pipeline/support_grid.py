"""The support grid of a build: its fineness, its frame, and which cubes are black or closed (thesis 3.2)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.errors import JobError
from amprep.geometry.overhangs import Overhangs
from amprep.geometry.voxels import UNMARKED, Grid, Window, holding_cubes, met_cubes, near_cubes
from amprep.model.arrays import CONTACT_TOLERANCE, Bools, Bytes, Floats, Ints
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.model.space import BuildVolume
from amprep.model.supports import Cube, GridFrame

FINEST_PITCH, USUAL_PITCH = 0.8, 2.0
"""mm; the bounds of the automatic pitch, before memory."""

_SQUARES_PER_PART = 12
_MOST_CUBES = 48_000_000
_TOO_MANY_MILLIONS = 400


def choose_pitch(parts: Sequence[PlacedPart], space: BuildVolume, strut_angle_deg: float = 45.0) -> float:
    """Return a pitch that suits the parts, in mm.

    The median part gets 12 squares along the geometric mean of its three extents, within 0.8 to 2.0 mm. The
    pitch is then raised until the box around all parts, from the plate up, has at most 48 million cubes.
    """
    bounds = [placed.mesh.bounds for placed in parts]
    if not bounds:
        return USUAL_PITCH
    sizes = [float(np.prod(hi - lo)) ** (1 / 3) for lo, hi in bounds]
    pitch = min(max(round(float(np.median(sizes)) / _SQUARES_PER_PART, 1), FINEST_PITCH), USUAL_PITCH)
    lo, hi = _common_bounds(bounds)
    extent = np.minimum(hi, space.size) - np.append(np.maximum(lo[:2], 0.0), 0.0)
    volume = float(np.prod(np.maximum(extent, 0.0)))
    while volume / (pitch**3 * np.tan(np.radians(strut_angle_deg))) > _MOST_CUBES:
        pitch = round(pitch + 0.1, 1)
    return pitch


def highest_need(meshes: Sequence[Mesh], overhangs: Sequence[Overhangs]) -> float:
    """Return the greatest height of anything that needs support, mm; 0 when nothing does."""
    height = 0.0
    for mesh, needs in zip(meshes, overhangs, strict=True):
        used = np.concatenate([mesh.triangles[needs.faces].ravel(), needs.edges.ravel(), needs.tips])
        height = max(height, float(mesh.vertices[used, 2].max(initial=0.0)))
    return height


def frame_of(
    meshes: Sequence[Mesh],
    overhangs: Sequence[Overhangs],
    space: BuildVolume,
    *,
    pitch: float,
    strut_angle_deg: float,
) -> GridFrame:
    """Lay the grid around the parts, within the build volume, up to the highest overhang.

    It is as much wider than the parts as paths from the highest plane can stray. No cube sticks out of the
    box; when the pitch does not divide the box and a part stands in the last, partial square, the grid is
    shifted to end at that wall.

    Raises
    ------
    JobError
        When that takes more than 400 million cubes.
    """
    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    top = min(_whole(highest_need(meshes, overhangs) / step) + 1, _whole(space.size[2] / step))
    lo, hi = _common_bounds([mesh.bounds for mesh in meshes])
    origin, count = np.zeros(3), [max(top, 1), 1, 1]
    for axis in (0, 1):
        whole = _whole(space.size[axis] / pitch)
        spare = float(space.size[axis]) - whole * pitch
        shift = spare if hi[axis] > whole * pitch and lo[axis] >= spare else 0.0
        first = max(int(np.floor((lo[axis] - shift) / pitch)) - top, 0)
        last = min(int(np.ceil((hi[axis] - shift) / pitch)) + top, whole)
        origin[axis] = shift + first * pitch
        count[2 - axis] = max(last - first, 1)
    millions = count[0] * count[1] * count[2] / 1e6
    if millions > _TOO_MANY_MILLIONS:
        raise JobError(
            f"the support grid must have at most {_TOO_MANY_MILLIONS} million cubes, got {millions:.0f} "
            f"million of {pitch:g} x {pitch:g} x {step:.3g} mm: choose a larger pitch"
        )
    return GridFrame(origin, pitch, step, (count[0], count[1], count[2]))


def _whole(count: float) -> int:
    return int(np.floor(count + 1e-9))


def _common_bounds(bounds: Sequence[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    if not bounds:
        return np.zeros(3), np.zeros(3)
    return np.min([lo for lo, _ in bounds], axis=0), np.max([hi for _, hi in bounds], axis=0)


def closed_cubes(frame: GridFrame, space: BuildVolume) -> Bools:
    """Tell which cubes are not wholly inside the build volume or meet a forbidden zone."""
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
    closed[_whole((space.size[2] + CONTACT_TOLERANCE) / frame.step) :] = True
    return closed


class PartCubes(NamedTuple):
    """One part's cubes in its window: those it meets, the region each needy cube holds, those it is near."""

    window: Window
    black: Bools
    region: Ints
    near: Bools | None


def cubes_of(mesh: Mesh, overhangs: Overhangs, frame: GridFrame, *, gap: float, solid: bool) -> PartCubes:
    """Voxelise one part; `near` only when `gap` (mm) is not 0."""
    grid = Grid(frame.origin, frame.pitch, frame.step, frame.shape)
    lo, hi = mesh.bounds
    window = grid.window(lo, hi, margin=gap)
    black = met_cubes(window, mesh.vertices, mesh.triangles, solid=solid)
    region = np.full(window.shape, UNMARKED, np.int32)
    if overhangs.regions:
        region = holding_cubes(window, mesh.vertices, mesh.triangles, overhangs)
        region[~black] = UNMARKED
    near = near_cubes(window, mesh.vertices, mesh.triangles, gap) if gap > 0 else None
    return PartCubes(window, black, region, near)


def coloured(frame: GridFrame, space: BuildVolume, parts: Sequence[PartCubes]) -> tuple[Bytes, Bytes]:
    """Return all cubes (values of `Cube`) and how many parts meet each, at most 2."""
    meeting = np.zeros(frame.shape, np.uint8)
    for part in parts:
        block = meeting[part.window.slices]
        np.minimum(block + part.black, 2, out=block, casting="unsafe")
    cubes = np.where(meeting > 0, np.uint8(Cube.BLACK), np.uint8(Cube.WHITE))
    cubes[closed_cubes(frame, space)] = Cube.CLOSED
    return cubes, meeting
