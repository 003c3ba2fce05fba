"""No-fit solids as unions of Minkowski sums of convex pieces, each given by the planes of its faces."""

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.prepared import planes_of
from amprep.kernels.no_fit.records import NoFitPieces

# Strategy. Shape a at offset o overlaps shape b at the origin if and only if o is a difference of a point of b and a
# point of a. For unions of convex pieces, these are the unions of the Minkowski sums B + (-A) of all pairs of pieces.
# The sum of two polyhedra is the hull of the sums of their corners. Where this has too many points, the planes of the
# faces of both, moved to the farthest point of the sum, bound a larger polyhedron: offsets outside it are outside the
# sum as well. A clearance c moves every plane outward by c. The result contains all offsets at a distance below c; it
# is too large at sharp edges and corners, which further planes along the edges and corners of a cube cut off.

MOST_SUMS = 3000
"""Number of sums of corners up to which a Minkowski sum is exact."""

AXES = np.vstack((np.eye(3), -np.eye(3)))

BEVELS = np.array(
    [[x, y, z] for x, y, z in product((-1.0, 0.0, 1.0), repeat=3) if abs(x) + abs(y) + abs(z) > 1.0]
)
BEVELS /= np.linalg.norm(BEVELS, axis=1)[:, None]

SAME_NORMAL = 0.15
"""Distance of unit normals below which one of them is enough for an inexact sum."""


def sum_planes(resting: Floats, moving: Floats) -> Floats:
    """Return planes ``(k, 4)`` that contain the Minkowski sum of a convex piece and the mirror image of another.

    The planes have outward unit normals; they are exact unless the pieces have more than `MOST_SUMS` pairs of corners.

    Parameters
    ----------
    resting, moving
        ``(m, 3)`` and ``(n, 3)`` mm, corners of the pieces; a difference of a point of the first and a point of the
        second is an offset of the second at which both overlap.
    """
    if len(resting) * len(moving) <= MOST_SUMS:
        return planes_of((resting[:, None] - moving[None]).reshape(-1, 3))
    normals = np.concatenate((AXES, planes_of(resting)[:, :3], -planes_of(moving)[:, :3]))
    return _support_planes(resting, moving, _distinct(normals))


def _support_planes(resting: Floats, moving: Floats, normals: Floats) -> Floats:
    """Return the planes with given normals that touch the Minkowski sum."""
    reach = (resting @ normals.T).max(axis=0) - (moving @ normals.T).min(axis=0)
    return np.column_stack((normals, reach))


def _distinct(normals: Floats) -> Floats:
    """Return unit normals of which no two are nearly equal; the first ones stay."""
    _, first = np.unique(np.round(normals / SAME_NORMAL), axis=0, return_index=True)
    return np.asarray(normals[np.sort(first)])


def no_fit_piece(resting: Floats, moving: Floats, clearance: float) -> tuple[Floats, Floats]:
    """Return the planes ``(k, 4)`` and the box ``(6,)`` of the offsets at which two pieces are nearer than a clearance.

    The polyhedron contains all such offsets; see the strategy above for where it is larger.
    """
    planes = sum_planes(resting, moving)
    if clearance > 0.0:
        planes = np.concatenate((planes, _support_planes(resting, moving, np.concatenate((AXES, BEVELS)))))
        planes[:, 3] += clearance
    lo, hi = resting.min(axis=0) - moving.max(axis=0), resting.max(axis=0) - moving.min(axis=0)
    return planes, np.concatenate((lo - clearance, hi + clearance))


def no_fit_pieces(
    moving: Sequence[Sequence[Floats]],
    obstacles: Sequence[Sequence[Floats]],
    clearances: Sequence[float],
    stop: Callable[[], bool],
) -> NoFitPieces | None:
    """Return the no-fit solids of all pairs of moving shapes, and of moving shapes with obstacles.

    Parameters
    ----------
    moving, obstacles
        For each shape its convex pieces, ``(k, 3)`` mm corners of each. Obstacles are numbered after the shapes.
    clearances
        Least distance (mm) of moving shapes, and of a moving shape from each obstacle.
    stop
        Asked before each pair of shapes.

    Returns
    -------
    The polyhedra, or None after a stop.
    """
    shapes, count = [*moving, *obstacles], len(moving)
    planes: list[Floats] = []
    boxes: list[Floats] = []
    first, end = np.zeros((2, len(shapes), len(shapes)), np.int64)
    for a in range(count):
        for b in [*range(a + 1), *range(count, len(shapes))]:
            if stop():
                return None
            gap = clearances[0] if b < count else clearances[1 + b - count]
            first[a, b] = len(boxes)
            for one, other in product(shapes[b], shapes[a]):
                faces, box = no_fit_piece(one, other, gap)
                planes.append(faces)
                boxes.append(box)
            end[a, b] = len(boxes)
    starts = np.cumsum([0] + [len(faces) for faces in planes]).astype(np.int64)
    return NoFitPieces(np.concatenate(planes), starts, np.array(boxes), first, end)
