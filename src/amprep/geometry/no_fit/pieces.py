"""No-fit solids as unions of Minkowski sums of convex pieces, each given by the planes of its faces."""

from collections.abc import Callable, Sequence
from itertools import product
from typing import NamedTuple

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

FEW = 4000
"""Number of polyhedra up to which sums are exact; an exact one takes a millisecond, another one a tenth of that."""

AXES = np.vstack((np.eye(3), -np.eye(3)))

BEVELS = np.array(
    [[x, y, z] for x, y, z in product((-1.0, 0.0, 1.0), repeat=3) if abs(x) + abs(y) + abs(z) > 1.0]
)
BEVELS /= np.linalg.norm(BEVELS, axis=1)[:, None]

SAME_NORMAL = 0.15
"""Distance of unit normals below which one of them is enough for an inexact sum."""

MOST_NORMALS = 24
"""Number of normals of a piece, of the greatest faces, that an inexact sum has."""


class ConvexPiece(NamedTuple):
    """A convex piece: its corners ``(k, 3)`` mm, and the unit normals ``(m, 3)`` of its greatest faces."""

    corners: Floats
    normals: Floats


def convex_piece(corners: Floats) -> ConvexPiece:
    """Return a piece with the normals of its faces, which are not those of `AXES`; flat pieces have none."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(corners)
    except (QhullError, ValueError):
        return ConvexPiece(corners, np.empty((0, 3)))
    a, b, c = corners[hull.simplices].swapaxes(0, 1)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    normals = hull.equations[:, :3]
    _, first, which = np.unique(
        np.round(normals / SAME_NORMAL), axis=0, return_index=True, return_inverse=True
    )
    total = np.bincount(which.ravel(), area)
    chosen = normals[first[np.argsort(-total, kind="stable")[:MOST_NORMALS]]]
    return ConvexPiece(corners, chosen[np.abs(chosen).max(axis=1) < 1.0 - 1e-9])


def sum_planes(resting: ConvexPiece, moving: ConvexPiece, *, exact: bool) -> Floats:
    """Return planes ``(k, 4)`` that contain the Minkowski sum of a convex piece and the mirror image of another.

    The planes have outward unit normals. They are exact if that is asked for and the pieces have at most `MOST_SUMS`
    pairs of corners. A difference of a point of the first piece and a point of the second is an offset of the second at
    which both overlap.
    """
    if exact and len(resting.corners) * len(moving.corners) <= MOST_SUMS:
        return planes_of((resting.corners[:, None] - moving.corners[None]).reshape(-1, 3))
    return _support_planes(resting, moving, np.concatenate((AXES, resting.normals, -moving.normals)))


def _support_planes(resting: ConvexPiece, moving: ConvexPiece, normals: Floats) -> Floats:
    """Return the planes with given normals that touch the Minkowski sum."""
    reach = (resting.corners @ normals.T).max(axis=0) - (moving.corners @ normals.T).min(axis=0)
    return np.column_stack((normals, reach))


def no_fit_piece(
    resting: ConvexPiece, moving: ConvexPiece, clearance: float, *, exact: bool = True
) -> tuple[Floats, Floats]:
    """Return the planes ``(k, 4)`` and the box ``(6,)`` of the offsets at which two pieces are nearer than a clearance.

    The polyhedron contains all such offsets; see the strategy above for where it is larger.
    """
    planes = sum_planes(resting, moving, exact=exact)
    if clearance > 0.0:
        further = np.concatenate((AXES, BEVELS)) if exact else BEVELS
        planes = np.concatenate((planes, _support_planes(resting, moving, further)))
        planes[:, 3] += clearance
    one, other = resting.corners, moving.corners
    lo, hi = one.min(axis=0) - other.max(axis=0), one.max(axis=0) - other.min(axis=0)
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
    shapes, count = (
        [[convex_piece(corners) for corners in shape] for shape in (*moving, *obstacles)],
        len(moving),
    )
    sizes = np.array([len(shape) for shape in shapes])
    exact = bool(sizes[:count].sum() * (sizes[:count].sum() / 2.0 + sizes[count:].sum()) <= FEW)
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
                faces, box = no_fit_piece(one, other, gap, exact=exact)
                planes.append(faces)
                boxes.append(box)
            end[a, b] = len(boxes)
    starts = np.cumsum([0] + [len(faces) for faces in planes]).astype(np.int64)
    return NoFitPieces(np.concatenate(planes), starts, np.array(boxes), first, end)
