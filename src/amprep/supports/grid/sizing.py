"""Choose the pitch, position and shape of the support grid of a build (thesis 3.2)."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.errors import JobError
from amprep.geometry.voxels.grid import Grid
from amprep.model.build import PlacedPart
from amprep.model.build_volume import BuildVolume
from amprep.overhangs.of_part import PartOverhangs
from amprep.supports.rules import PlanningRules

FINEST_PITCH, USUAL_PITCH = 0.8, 2.0
"""Bounds (mm) of the automatic pitch, before the memory limit is applied."""

PITCH_PER_WALL = 8.0 / 3.0
"""Smallest automatic pitch over the least wall: thicker walls would close the cells."""

_SQUARES_PER_PART = 12
"""Number of voxels along the mean extent of the median part."""

_BYTES_PER_VOXEL = 40
"""Peak memory of a voxel, measured with the exact routers; `shortest-paths` takes half."""


def least_pitch(least_wall: float) -> float:
    """Return the smallest pitch (mm, in tenths) whose cells walls of the least wall (mm) do not close."""
    return float(np.ceil(10.0 * PITCH_PER_WALL * least_wall - 1e-9)) / 10.0


def usual_pitch(parts: Sequence[PlacedPart], least_wall: float = 0.0) -> float:
    """Return the pitch (mm) at which the median part has 12 voxels along its mean extent, within 0.8 to 2.0 mm.

    The mean extent of a part is the geometric mean of the three sides of its bounding box. The pitch is at least
    `PITCH_PER_WALL` times the least wall (mm).
    """
    finest = max(FINEST_PITCH, least_pitch(least_wall))
    bounds = [placed.mesh.bounds for placed in parts]
    if not bounds:
        return max(USUAL_PITCH, finest)
    sizes = [float(np.prod(hi - lo)) ** (1 / 3) for lo, hi in bounds]
    return min(max(round(float(np.median(sizes)) / _SQUARES_PER_PART, 1), finest), max(USUAL_PITCH, finest))


def choose_pitch(parts: Sequence[PlacedPart], space: BuildVolume, rules: PlanningRules) -> float:
    """Return the pitch of the rules (mm) or, if they leave it open, a pitch that suits parts and memory.

    This is the usual pitch, or the smallest larger one in tenths of a millimetre whose grid, as high as the
    highest part, fits into ``rules.memory_mb``.

    Parameters
    ----------
    parts
        The parts of one build.
    space
        The build volume.
    rules
        Pitch, strut angle and memory.
    """
    if rules.pitch_mm is not None:
        return rules.pitch_mm
    pitch = usual_pitch(parts, rules.least_wall_mm)
    while estimated_megabytes(parts, space, pitch, rules.strut_angle_deg) > rules.memory_mb:
        pitch = round(pitch * 1.05 + 0.05, 1)
    return pitch


def estimated_megabytes(
    parts: Sequence[PlacedPart], space: BuildVolume, pitch: float, strut_angle_deg: float
) -> float:
    """Return the approximate memory (MB) of a grid that is as high as the parts."""
    bounds = [placed.mesh.bounds for placed in parts]
    step = pitch * float(np.tan(np.radians(strut_angle_deg)))
    return _megabytes(_extent(bounds, float(_common_bounds(bounds)[1][2]), space, pitch, step)[1])


def _megabytes(count: Sequence[int]) -> float:
    return float(np.prod(np.array(count, np.float64))) * _BYTES_PER_VOXEL / 1e6


def lay_grid(parts: Sequence[PartOverhangs], space: BuildVolume, pitch: float, rules: PlanningRules) -> Grid:
    """Return the grid around the parts, inside the build volume, up to the highest overhang.

    The grid is wider than the parts by the distance that paths from its top plane can move sideways. No voxel
    leaves the build volume. Where the pitch does not divide the build volume and a part reaches into the
    incomplete last column of voxels, the grid is shifted so that it ends at that wall.

    Parameters
    ----------
    parts
        Meshes and overhangs of the placed parts.
    space
        The build volume.
    pitch
        Horizontal voxel size, mm.
    rules
        The strut angle, which gives the voxel height ``pitch * tan(strut angle)``, and the memory.

    Raises
    ------
    JobError
        If the grid takes more memory than allowed.
    """
    step = pitch * float(np.tan(np.radians(rules.strut_angle_deg)))
    origin, count = _extent(
        [part.mesh.bounds for part in parts], _highest_overhang(parts), space, pitch, step
    )
    megabytes = _megabytes(count)
    if megabytes > rules.memory_mb:
        fitting = max(round(pitch * (megabytes / rules.memory_mb) ** (1 / 3) + 0.05, 1), 0.1)
        raise JobError(
            f"a support grid of {pitch:g} x {pitch:g} x {step:.3g} mm takes about {megabytes:.0f} MB, more than "
            f"supports.memory_mb = {rules.memory_mb}: choose a larger pitch (--set supports.pitch_mm={fitting:g}) or "
            "allow more memory"
        )
    return Grid(origin, pitch, step, (count[0], count[1], count[2]))


def _highest_overhang(parts: Sequence[PartOverhangs]) -> float:
    """Return the largest height of an overhang, mm; 0 without overhangs."""
    height = 0.0
    for mesh, overhangs in parts:
        used = [mesh.triangles[overhangs.faces].ravel(), overhangs.edges.ravel(), overhangs.tips]
        height = max(height, float(mesh.vertices[np.concatenate(used), 2].max(initial=0.0)))
    return height


def _extent(
    bounds: Sequence[tuple[Floats, Floats]], height: float, space: BuildVolume, pitch: float, step: float
) -> tuple[Floats, list[int]]:
    """Return the origin and the voxel counts (z, y, x) of a grid for overhangs up to `height` mm."""
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
    """Return `count` rounded down, with a tolerance for rounding errors."""
    return int(np.floor(count + 1e-9))


def _common_bounds(bounds: Sequence[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    if not bounds:
        return np.zeros(3), np.zeros(3)
    return np.min([lo for lo, _ in bounds], axis=0), np.max([hi for _, hi in bounds], axis=0)
