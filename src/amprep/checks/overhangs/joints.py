"""Find overhangs that stand on another body of the same part, or are carried by one beside them.

Strategy. Where two bodies of a mesh touch, a level downward face has the solid directly below it, although the mesh has
faces there. The judge looks for the solid itself: just below a point, and just below and above points on horizontal
lines from it. A line ends where it leaves the solid above.
"""

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.overhangs.surface import MergedMesh
from amprep.geometry.meshes.containment import inside

_DEPTH = 0.01
"""Distance (mm) above and below a face at which the judge looks for the solid."""

_WAYS, _STEP = 16, 0.1
"""Number of lines from a point, and distance (mm) of the points on them."""

_CHUNK = 1000
"""Number of points that are judged at once."""


def stand_on_bodies(surface: MergedMesh, points: Floats, reach: float) -> Bools:
    """Tell which points of level downward faces another body carries from directly below, ``(n,)``.

    Parameters
    ----------
    surface
        The part.
    points
        ``(n, 3)`` mm, a little inside their faces.
    reach
        Greatest length (mm) of a line in plan from a point to where the solid is below the face.
    """
    found = np.zeros(len(points), np.bool_)
    level = surface.triangles[np.abs(surface.normal[:, 2] - 1.0) < 1e-6]
    tops = np.unique(surface.points[level, 2])
    place = np.searchsorted(tops, points[:, 2] - _DEPTH)
    rows = np.flatnonzero(place < np.searchsorted(tops, points[:, 2] + _DEPTH))
    found[rows] = _solid_at(surface, points[rows], -_DEPTH)
    rows = rows[~found[rows]]
    for each in np.split(rows, np.arange(_CHUNK, len(rows), _CHUNK)):
        found[each] = _reach_solid(surface, points[each], reach)
    return found


def _reach_solid(surface: MergedMesh, points: Floats, reach: float) -> Bools:
    """Tell from which points a line in plan leads over the face to where the solid is below it."""
    angle = 2.0 * np.pi * np.arange(_WAYS) / _WAYS
    way = np.stack([np.cos(angle), np.sin(angle), np.zeros(_WAYS)], axis=1)
    on_line, found = np.ones((len(points), _WAYS), np.bool_), np.zeros(len(points), np.bool_)
    for length in np.append(np.arange(_STEP, reach, _STEP), reach).tolist():
        point, line = np.nonzero(on_line & ~found[:, None])
        places = points[point] + length * way[line]
        on_line[point, line] = _solid_at(surface, places, _DEPTH)
        found[point[on_line[point, line] & _solid_at(surface, places, -_DEPTH)]] = True
    return found


def _solid_at(surface: MergedMesh, points: Floats, rise: float) -> Bools:
    """Tell which points are inside the solid if they are moved upwards by `rise`."""
    return inside(points + np.array([0.0, 0.0, rise]), surface.points, surface.triangles.astype(np.int32))
