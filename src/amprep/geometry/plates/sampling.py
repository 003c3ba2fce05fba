"""Sample outlines for the fields of depth: signed distances on a fine grid, and points along the sides."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Int16s, Int32s, Int64s, starts_of
from amprep.geometry.plates.outline import ShadowOutline, sides_of
from amprep.kernels.plates.distance import sample_distances
from amprep.kernels.plates.records import PHASES, UNITS, SampledOutlines

SPACING = 0.5
"""Greatest distance of sampled points along a side, in steps."""

INSIDE = 2
"""Distance of sampled points inside an outline, in steps; 1 if there are outlines of several components."""

DEEP = -0.4
"""Signed distance, in steps, of sampled points inside."""

CAREFUL = 0.6
"""Fraction of the distance of a corner from its sampled point by which it counts as nearer to others."""

MARGIN = 3.0
"""Distance beyond the clearance, in steps, up to which signed distances are sampled around an outline."""


def sample_outlines(
    outlines: Sequence[ShadowOutline], clearances: Sequence[float], step: float, radius: float
) -> SampledOutlines:
    """Return outlines sampled for fields with a step (mm).

    Points inside tell the overlap where one outline contains another, or the same one.

    Parameters
    ----------
    outlines
        In the order of increasing area: so none contains a later one.
    clearances
        Least distance (mm) of other outlines, for each outline.
    radius
        Radius (mm) within which outlines may be on a round plate; then the last outline stands for its edge. 0 for
        other plates.
    """
    reach = max(clearances, default=0.0) + MARGIN * step
    last = len(outlines) - 1
    spacing = INSIDE if all(outline.is_connected for outline in outlines) else 1
    distances, points, shifts, cells = [], [], [], []
    for k, outline in enumerate(outlines):
        size = np.ceil((outline.half + reach) / step).astype(np.int64)
        if radius and k == last:
            size[:] = 0
        cells.append(size)
        field = _distances(outline, size, step)
        at, shift = _points(outline, step)
        inside = _inside(field[0, 0], spacing)
        distances.append(field.ravel())
        points.append(np.concatenate((at, inside)))
        shifts.append(np.concatenate((shift, np.zeros(len(inside), np.int16))))
    return SampledOutlines(
        half=np.array([outline.half for outline in outlines]).reshape(-1, 2),
        clearance=np.array(clearances, np.float64),
        distance=np.concatenate(distances),
        first_distance=starts_of(distances)[:-1],
        cells=np.array(cells, np.int64).reshape(-1, 2),
        point=np.concatenate(points),
        shift=np.concatenate(shifts),
        first_point=starts_of(points),
        corner=np.concatenate([outline.hull for outline in outlines]),
        first_corner=starts_of([outline.hull for outline in outlines]),
        step=step,
        bed=last if radius else -1,
        radius=radius,
    )


def _distances(outline: ShadowOutline, cells: Int64s, step: float) -> Int16s:
    out = np.empty((PHASES, PHASES, *(2 * cells + 1).tolist()), np.int16)
    work = np.empty((2, PHASES * out.shape[3]))
    sample_distances(sides_of(outline.loops), step, work[0], work[1], out)
    return out


def _points(outline: ShadowOutline, step: float) -> tuple[Int32s, Int16s]:
    """Return fine grid points near corners and sides, and what is added to the distances there.

    The distance to an outline that faces a side falls along the normal of the side.
    """
    sides = sides_of(outline.loops)
    start, along = sides[:, :2], sides[:, 2:] - sides[:, :2]
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-12)
    count = np.maximum(np.ceil(length / (SPACING * step)), 1.0).astype(np.int64)
    row = np.repeat(np.arange(len(sides)), count)
    number = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    exact = start[row] + along[row] * (number / count[row])[:, None]
    fine = step / PHASES
    point = np.round(exact / fine)
    normal = np.column_stack((along[:, 1], -along[:, 0])) / length[:, None]
    moved = exact - point * fine
    along_normal = -(moved * normal[row]).sum(axis=1)
    shift = np.where(number > 0, along_normal, -CAREFUL * np.hypot(moved[:, 0], moved[:, 1]))
    return point.astype(np.int32), np.round(shift / step * UNITS).astype(np.int16)


def _inside(distances: Int16s, spacing: int) -> Int32s:
    """Return fine grid points well inside an outline, from its signed distances at the grid points."""
    middle = np.array(distances.shape) // 2
    at = np.argwhere(distances < DEEP * UNITS) - middle
    return np.asarray(at[(at % spacing == 0).all(axis=1)] * PHASES, np.int32)
