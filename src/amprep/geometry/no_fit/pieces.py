"""No-fit solids as unions of Minkowski sums of convex pieces, each given by the planes of its faces."""

from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.bounding.convex.prepared import planes_of
from amprep.kernels.no_fit.records import NoFitSolid

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

SAME_NORMAL, ALIKE = 0.15, 0.05
"""Distance of unit normals below which one is enough, where there are more than `MOST_NORMALS` or `MOST_FACES`."""

MOST_NORMALS, MOST_FACES, MOST_EDGES = 24, 100, 12
"""Number of normals of a piece for contacts and for voxels, and of directions of edges; of more edges none is kept."""


class ConvexPiece(NamedTuple):
    """A convex piece.

    Attributes
    ----------
    corners
        ``(k, 3)`` mm.
    normals
        ``(m, 3)`` outward unit normals of its greatest faces, without those of `AXES`; a flat piece has none.
    faces
        ``(f, 3)`` the same with more faces, where there are many.
    edges
        ``(n, 3)`` unit vectors along its edges, one of both directions; none if there are more than `MOST_EDGES`.
    """

    corners: Floats
    normals: Floats
    faces: Floats
    edges: Floats


class ShapeSet(NamedTuple):
    """Moving shapes, then obstacles, as convex pieces.

    Attributes
    ----------
    shapes
        The pieces of each shape.
    moving
        Number of moving shapes; the others are obstacles.
    clearance
        ``(n,)`` least distance (mm) of moving shapes from each.
    """

    shapes: Sequence[Sequence[ConvexPiece]]
    moving: int
    clearance: Floats

    @property
    def boxes(self) -> tuple[Floats, Floats]:
        """Least and greatest corners of the shapes, ``(n, 3)`` mm each."""
        points = [np.concatenate([piece.corners for piece in shape]) for shape in self.shapes]
        lo, hi = [each.min(axis=0) for each in points], [each.max(axis=0) for each in points]
        return np.array(lo).reshape(-1, 3), np.array(hi).reshape(-1, 3)


def shape_set(
    moving: Sequence[Sequence[Floats]], obstacles: Sequence[Sequence[Floats]], clearances: Sequence[float]
) -> ShapeSet:
    """Return moving shapes and obstacles, each given by the corners ``(k, 3)`` mm of its convex pieces.

    Parameters
    ----------
    clearances
        Least distance (mm) of moving shapes, and of a moving shape from each obstacle.
    """
    return with_obstacles([convex_shape(shape) for shape in moving], obstacles, clearances)


def with_obstacles(
    moving: Sequence[Sequence[ConvexPiece]],
    obstacles: Sequence[Sequence[Floats]],
    clearances: Sequence[float],
) -> ShapeSet:
    """Return prepared moving shapes and obstacles; see `shape_set`."""
    shapes = [*moving, *(convex_shape(shape) for shape in obstacles)]
    each = [clearances[0]] * len(moving) + list(clearances[1:])
    return ShapeSet(shapes, len(moving), np.array(each, np.float64))


def convex_shape(pieces: Sequence[Floats]) -> list[ConvexPiece]:
    """Return the pieces of a shape, each given by its corners ``(k, 3)`` mm."""
    return [convex_piece(corners) for corners in pieces]


def convex_piece(corners: Floats) -> ConvexPiece:
    """Return a piece with the normals of its faces and the directions of its edges."""
    from scipy.spatial import ConvexHull, QhullError

    none = np.empty((0, 3))
    try:
        hull = ConvexHull(corners)
    except (QhullError, ValueError):
        return ConvexPiece(corners, none, none, none)
    a, b, c = corners[hull.simplices].swapaxes(0, 1)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    slanted = np.abs(hull.equations[:, :3]).max(axis=1) < 1.0 - 1e-9
    normals, area = hull.equations[slanted, :3], area[slanted]
    faces = _greatest_normals(normals, area, ALIKE, MOST_FACES)
    normals = _greatest_normals(normals, area, SAME_NORMAL, MOST_NORMALS)
    edges = _edges(corners, hull) if len(faces) <= MOST_NORMALS else none
    return ConvexPiece(corners, normals, faces, edges)


def _greatest_normals(normals: Floats, area: Floats, alike: float, most: int) -> Floats:
    """Return all different normals, or, where these are too many, those of most area of different kinds."""
    _, first = np.unique(_keys(normals, 1e-7), return_index=True)
    if len(first) <= most:
        return np.asarray(normals[np.sort(first)])
    _, first, which = np.unique(_keys(normals, alike), return_index=True, return_inverse=True)
    total = np.bincount(which, area)
    return np.asarray(normals[first[np.argsort(-total, kind="stable")[:most]]])


def _keys(units: Floats, same: float) -> Int64s:
    """Return a number for each unit vector, equal for those that are rounded to the same multiples of a length."""
    whole = np.round(units / same).astype(np.int64)
    most = 2 * int(1.0 / same) + 3
    return np.asarray((whole[:, 0] * most + whole[:, 1]) * most + whole[:, 2])


def _edges(corners: Floats, hull: Any) -> Floats:
    """Return the directions of the edges between faces that are not in one plane; none if these are many."""
    normals, found = hull.equations[:, :3], []
    for opposite in range(3):
        ends = np.delete(hull.simplices, opposite, axis=1)
        bent = (normals * normals[hull.neighbors[:, opposite]]).sum(axis=1) < 1.0 - 1e-9
        found.append((corners[ends[:, 1]] - corners[ends[:, 0]])[bent])
    edges = np.concatenate(found)
    edges = edges / np.linalg.norm(edges, axis=1)[:, None]
    first = (np.abs(edges) > 1e-6).argmax(axis=1)
    edges = edges * np.sign(edges[np.arange(len(edges)), first])[:, None]
    _, kept = np.unique(_keys(edges, 1e-6), return_index=True)
    return edges[np.sort(kept)] if len(kept) <= MOST_EDGES else np.empty((0, 3))


def sum_planes(resting: ConvexPiece, moving: ConvexPiece) -> Floats:
    """Return planes ``(k, 4)`` that contain the Minkowski sum of a convex piece and the mirror image of another.

    The planes have outward unit normals. They are exact if the pieces have at most `MOST_SUMS` pairs of corners. A
    difference of a point of the first piece and a point of the second is an offset of the second at which both overlap.
    """
    if len(resting.corners) * len(moving.corners) <= MOST_SUMS:
        return planes_of((resting.corners[:, None] - moving.corners[None]).reshape(-1, 3))
    return _support_planes(resting, moving, np.concatenate((AXES, resting.normals, -moving.normals)))


def _support_planes(resting: ConvexPiece, moving: ConvexPiece, normals: Floats) -> Floats:
    """Return the planes with given normals that touch the Minkowski sum."""
    reach = (resting.corners @ normals.T).max(axis=0) - (moving.corners @ normals.T).min(axis=0)
    return np.column_stack((normals, reach))


def no_fit_piece(resting: ConvexPiece, moving: ConvexPiece, clearance: float) -> tuple[Floats, Floats]:
    """Return the planes ``(k, 4)`` and the box ``(6,)`` of the offsets at which two pieces are nearer than a clearance.

    The polyhedron contains all such offsets; see the strategy above for where it is larger.
    """
    planes = sum_planes(resting, moving)
    if clearance > 0.0:
        further = _support_planes(resting, moving, np.concatenate((AXES, BEVELS)))
        planes = np.concatenate((planes, further))
        planes[:, 3] += clearance
    one, other = resting.corners, moving.corners
    lo, hi = one.min(axis=0) - other.max(axis=0), one.max(axis=0) - other.min(axis=0)
    return planes, np.concatenate((lo - clearance, hi + clearance))


def no_fit_solid(
    resting: Sequence[ConvexPiece], moving: Sequence[ConvexPiece], clearance: float
) -> NoFitSolid:
    """Return the offsets at which a moving shape is nearer to a resting one than a clearance."""
    found = [no_fit_piece(one, other, clearance) for one, other in product(resting, moving)]
    starts = np.cumsum([0] + [len(planes) for planes, _ in found]).astype(np.int64)
    return NoFitSolid(
        np.concatenate([planes for planes, _ in found]), starts, np.array([box for _, box in found])
    )


def corner_pairs(shapes: ShapeSet) -> int:
    """Return the number of pairs of corners of all pairs of shapes; the time that exact sums take grows with it."""
    corners = [sum(len(piece.corners) for piece in shape) for shape in shapes.shapes]
    moving, resting = corners[: shapes.moving], corners[shapes.moving :]
    squares = sum(count**2 for count in moving)
    return (sum(moving) ** 2 + squares) // 2 + sum(moving) * sum(resting)
