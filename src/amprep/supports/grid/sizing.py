"""The support grid of a build: its fineness, its frame, and which voxels are black or closed (thesis 3.2)."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.errors import JobError
from amprep.geometry.overhangs.regions import Overhangs
from amprep.geometry.voxels.grid import Grid
from amprep.model.build import PlacedPart
from amprep.model.build_volume import BuildVolume
from amprep.model.mesh import Mesh

FINEST_PITCH, USUAL_PITCH = 0.8, 2.0
"""mm; the bounds of the automatic pitch, before memory."""

MEMORY_MB = 2000
"""Default budget of a support grid."""

_SQUARES_PER_PART = 12

_BYTES_PER_CUBE = 40
"""At the peak, measured with the exact routers; `shortest-paths` takes half."""


def usual_pitch(parts: Sequence[PlacedPart]) -> float:
    """Return a pitch that suits the parts, in mm.

    The median part gets 12 squares along the geometric mean of its three extents, within 0.8 to 2.0 mm.
    """
    bounds = [placed.mesh.bounds for placed in parts]
    if not bounds:
        return USUAL_PITCH
    sizes = [float(np.prod(hi - lo)) ** (1 / 3) for lo, hi in bounds]
    return min(max(round(float(np.median(sizes)) / _SQUARES_PER_PART, 1), FINEST_PITCH), USUAL_PITCH)


def choose_pitch(
    parts: Sequence[PlacedPart], space: BuildVolume, strut_angle_deg: float = 45.0, memory_mb: int = MEMORY_MB
) -> float:
    """Return the usual pitch, or the least larger one (by tenths of a mm) whose grid keeps to the memory.

    The grid is taken to be as high as the parts.
    """
    pitch = usual_pitch(parts)
    while estimated_megabytes(parts, space, pitch, strut_angle_deg) > memory_mb:
        pitch = round(pitch * 1.05 + 0.05, 1)
    return pitch


def estimated_megabytes(
    parts: Sequence[PlacedPart], space: BuildVolume, pitch: float, strut_angle_deg: float
) -> float:
    """Return about what a grid as high as the parts takes."""
    bounds = [placed.mesh.bounds for placed in parts]
    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    return _megabytes(_extent(bounds, float(_common_bounds(bounds)[1][2]), space, pitch, step)[1])


def _megabytes(count: Sequence[int]) -> float:
    return float(np.prod(np.array(count, np.float64))) * _BYTES_PER_CUBE / 1e6


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
    memory_mb: int = MEMORY_MB,
) -> Grid:
    """Lay the grid around the parts, within the build volume, up to the highest overhang.

    It is as much wider than the parts as paths from the highest plane can stray. No voxel sticks out of the
    box; when the pitch does not divide the box and a part stands in the last, partial square, the grid is
    shifted to end at that wall.

    Raises
    ------
    JobError
        When that takes more memory than `memory_mb`.
    """
    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    bounds = [mesh.bounds for mesh in meshes]
    origin, count = _extent(bounds, highest_need(meshes, overhangs), space, pitch, step)
    megabytes = _megabytes(count)
    if megabytes > memory_mb:
        fitting = max(round(pitch * (megabytes / memory_mb) ** (1 / 3) + 0.05, 1), 0.1)
        raise JobError(
            f"the support grid of {pitch:g} x {pitch:g} x {step:.3g} mm takes about {megabytes:.0f} MB, more than "
            f"supports.memory_mb = {memory_mb}: choose a larger pitch (--set supports.pitch_mm={fitting:g}) or allow "
            "more memory"
        )
    return Grid(origin, pitch, step, (count[0], count[1], count[2]))


def _extent(
    bounds: Sequence[tuple[Floats, Floats]], height: float, space: BuildVolume, pitch: float, step: float
) -> tuple[Floats, list[int]]:
    """Return the origin, and the numbers of voxels (z, y, x), of a grid for overhangs up to `height` mm."""
    top = max(min(whole_count(height / step) + 1, whole_count(space.size[2] / step)), 1)
    lo, hi = _common_bounds(bounds)
    origin, count = np.zeros(3), [top, 1, 1]
    for axis in (0, 1):
        whole = whole_count(space.size[axis] / pitch)
        spare = float(space.size[axis]) - whole * pitch
        shift = spare if hi[axis] > whole * pitch and lo[axis] >= spare else 0.0
        first = max(int(np.floor((lo[axis] - shift) / pitch)) - top, 0)
        last = min(int(np.ceil((hi[axis] - shift) / pitch)) + top, whole)
        origin[axis] = shift + first * pitch
        count[2 - axis] = max(last - first, 1)
    return origin, count


def whole_count(count: float) -> int:
    """Return the number of voxels that cover a length of `count` voxels."""
    return int(np.floor(count + 1e-9))


def _common_bounds(bounds: Sequence[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    if not bounds:
        return np.zeros(3), np.zeros(3)
    return np.min([lo for lo, _ in bounds], axis=0), np.max([hi for _, hi in bounds], axis=0)
