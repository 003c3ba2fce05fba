"""Step away from the borders of overhang regions that nothing carries."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import kernel, uncounted
from amprep.kernels.overhangs.walks import FAR, FREE, WalkableFaces, walk

_DIRECTIONS = 32


@uncounted
def _height(faces: WalkableFaces, face: int, x: float, y: float) -> float:
    """Return the height of the plane of a face at a point in plan."""
    a, b, c = faces.corners[face, 0], faces.corners[face, 1], faces.corners[face, 2]
    twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
    to_b = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / twice
    to_c = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / twice
    height: float = a[2] + to_b * (b[2] - a[2]) + to_c * (c[2] - a[2])
    return height


@kernel
def step_from_rims(
    faces: WalkableFaces, points: Floats, face: Int64s, rim: float, plate: float, moved: Floats, on: Int64s
) -> None:
    """Move points that are near a border that nothing carries to the distance `rim` from it.

    Where the region ends before, they move half-way to its other border.

    Parameters
    ----------
    faces
        The faces of the regions.
    points, face
        ``(n, 3)`` mm, and the face ``(n,)`` that each is on.
    rim
        Distance, mm.
    plate
        Height (mm) up to which a region is on the plate.
    moved, on
        ``(n, 3)`` out: mm, and the face ``(n,)`` that each is on then; -1 for points that are not near such a border.
    """
    for n in range(len(points)):
        point = (points[n, 0], points[n, 1], points[n, 2])
        near, dx, dy = rim, 0.0, 0.0
        for k in range(_DIRECTIONS):
            x, y = np.cos(2 * np.pi * k / _DIRECTIONS), np.sin(2 * np.pi * k / _DIRECTIONS)
            end = walk(faces, face[n], point, (x, y), near, np.inf, plate, 0.0)
            if end.kind == FREE and end.length < near:
                near, dx, dy = end.length, -x, -y
        on[n] = -1
        if near < rim:
            length = rim - near
            end = walk(faces, face[n], point, (dx, dy), length, np.inf, plate, 0.0)
            if end.kind != FAR:
                length = min(end.length, length) / 2
                end = walk(faces, face[n], point, (dx, dy), length, np.inf, plate, 0.0)
            on[n] = end.face
            moved[n, 0], moved[n, 1] = point[0] + length * dx, point[1] + length * dy
            moved[n, 2] = _height(faces, end.face, moved[n, 0], moved[n, 1])
