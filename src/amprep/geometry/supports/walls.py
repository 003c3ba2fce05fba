"""Walls of parts (faces that supports neither hold nor stand on), and the space beside them that stays free."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Ints
from amprep.geometry.overhangs.regions import Overhangs

if TYPE_CHECKING:
    from manifold3d import Manifold


_LEVEL = 1e-6
"""Horizontal component of a unit normal below which a face counts as level."""

_UP = 1e-3
"""Vertical component of a unit normal above which a face points up."""

_CORNERS = 9
"""Corners of the polygon around the half disc by which a wall is swept; it exceeds the radius by at most 2 %."""

_MOST_CELLS, _LONGEST, _FINEST = 2_000_000, 2000, 0.5
"""Largest number of cells of a grid, in total and along its longest side; least size of a cell, mm."""


class PartWalls(NamedTuple):
    """Walls of a part.

    Attributes
    ----------
    corners
        ``(n, 3, 3)`` mm.
    outward
        ``(n, 2)`` unit vectors, horizontal direction out of the part.
    """

    corners: Floats
    outward: Floats

    def chosen(self, keep: Bools) -> "PartWalls":
        """Return the walls for which `keep` ``(n,)`` is true."""
        return PartWalls(self.corners[keep], self.outward[keep])


def walls_of(
    vertices: Floats, triangles: Ints, held: Overhangs, overlap: float, *, stood_on: bool = False
) -> PartWalls:
    """Return all faces of a mesh that are neither level nor overhangs.

    Parameters
    ----------
    vertices, triangles
        The mesh, ``(n, 3)`` mm and ``(m, 3)``.
    held
        Overhangs; neither their faces nor those beside them, to which contacts extend, are walls, and above their
        edges and tips walls begin `overlap` higher.
    overlap
        Depth (mm) to which supports enter the part.
    stood_on
        Whether supports may stand on the part; then faces that point up are no walls.
    """
    first, second, third = (vertices[triangles[:, i]] for i in range(3))
    normal = np.cross(second - first, third - first)
    length = np.linalg.norm(normal, axis=1)
    aside = np.linalg.norm(normal[:, :2], axis=1)
    keep = aside > _LEVEL * np.maximum(length, 1e-300)
    keep[held.faces] = False
    keep[held.beside] = False
    if stood_on:
        keep &= normal[:, 2] <= _UP * length
    sharp = np.zeros(len(vertices), np.bool_)
    sharp[held.edges], sharp[held.tips] = True, True
    begins = sharp[triangles]
    cut = keep & begins.any(axis=1)
    clipped, owner = _clipped(vertices[triangles[cut]], begins[cut], overlap)
    number = np.concatenate([np.flatnonzero(keep & ~cut), np.flatnonzero(cut)[owner]])
    corners = np.concatenate([vertices[triangles[keep & ~cut]], clipped])
    return PartWalls(corners, normal[number, :2] / aside[number, None])


def _clipped(corners: Floats, sharp: Bools, overlap: float) -> tuple[Floats, NDArray[np.int64]]:
    """Remove the part of triangles ``(n, 3, 3)`` within `overlap` mm above their sharp corners.

    Heights are measured from the sharp corner, or from the mean height of two. Returns the remaining
    triangles and the index of the triangle from which each comes.
    """
    z = corners[:, :, 2]
    base = np.where(sharp, z, 0.0).sum(axis=1) / sharp.sum(axis=1)
    height = np.where(sharp, 0.0, z - base[:, None]) - overlap
    found: list[Floats] = []
    owner: list[int] = []
    for index, (triangle, above) in enumerate(zip(corners, height, strict=True)):
        outline = []
        for i in range(3):
            j = (i + 1) % 3
            if above[i] >= 0.0:
                outline.append(triangle[i])
            if above[i] * above[j] < 0.0:
                fraction = above[i] / (above[i] - above[j])
                outline.append(triangle[i] + fraction * (triangle[j] - triangle[i]))
        for i in range(1, len(outline) - 1):
            found.append(np.array([outline[0], outline[i], outline[i + 1]]))
            owner.append(index)
    return np.array(found).reshape(-1, 3, 3), np.array(owner, np.int64)


class OccupancyGrid(NamedTuple):
    """Grid that counts the cells which boxes occupy (three-dimensional summed-area table).

    Attributes
    ----------
    origin, side
        Least corner ``(3,)`` of the grid and size of a cell, mm.
    before
        ``(nx + 1, ny + 1, nz + 1)`` number of occupied cells below each corner of the grid along all axes.
    """

    origin: Floats
    side: float
    before: NDArray[np.int64]

    def near(self, corners: Floats, distance: float) -> Bools:
        """Tell which triangles ``(n, 3, 3)`` may have one of the boxes within `distance` mm horizontally.

        All other triangles have none.
        """
        aside = np.array([distance, distance, 0.0])
        shape = np.array(self.before.shape) - 1
        first = np.floor((corners.min(axis=1) - aside - self.origin) / self.side)
        behind = np.floor((corners.max(axis=1) + aside - self.origin) / self.side) + 1
        first, behind = (np.clip(each, 0, shape).astype(np.int64) for each in (first, behind))
        found = np.zeros(len(corners), np.int64)
        for end in np.ndindex(2, 2, 2):
            sign = 1 - 2 * ((3 - sum(end)) % 2)
            found += sign * self.before[tuple(np.where(end, behind, first).T)]
        return np.asarray(found > 0)


def occupancy_of(lo: Floats, hi: Floats) -> OccupancyGrid:
    """Return a grid over boxes from `lo` to `hi` ``(k, 3)`` mm with the cells that they occupy."""
    if not len(lo):
        return OccupancyGrid(np.zeros(3), 1.0, np.zeros((2, 2, 2), np.int64))
    origin = lo.min(axis=0)
    extent = np.maximum(hi.max(axis=0) - origin, _FINEST)
    side = max(float(np.cbrt(extent.prod() / _MOST_CELLS)), float(extent.max()) / _LONGEST, _FINEST)
    shape = np.floor(extent / side).astype(np.int64) + 1
    first, last = (
        np.clip(np.floor((each - origin) / side), 0, shape - 1).astype(np.int64) for each in (lo, hi)
    )
    change = np.zeros(int((shape + 1).prod()))
    for end in np.ndindex(2, 2, 2):
        place = np.ravel_multi_index(tuple(np.where(end, last + 1, first).T), tuple(shape + 1))
        change += (1 - 2 * (sum(end) % 2)) * np.bincount(place, minlength=len(change))
    covers = change.reshape(shape + 1).cumsum(axis=0).cumsum(axis=1).cumsum(axis=2)[:-1, :-1, :-1]
    before = np.zeros(shape + 1, np.int64)
    before[1:, 1:, 1:] = (covers > 0.5).cumsum(axis=0).cumsum(axis=1).cumsum(axis=2)
    return OccupancyGrid(origin, side, before)


def spaces_beside(walls: PartWalls, gap: float) -> list["Manifold"]:
    """Return for each wall the space on its outer side within the horizontal distance `gap` mm.

    The sweep of a triangle by a half disc is the convex hull of its corners plus those of the disc.
    """
    from manifold3d import Manifold

    angle = np.linspace(-np.pi / 2, np.pi / 2, _CORNERS)
    radius = gap / np.cos(np.pi / (2 * (_CORNERS - 1)))
    half_disc = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    along = np.column_stack([-walls.outward[:, 1], walls.outward[:, 0]])
    moves = walls.outward[:, None] * half_disc[:, :1] + along[:, None] * half_disc[:, 1:]
    points = np.repeat(walls.corners[:, None], len(half_disc), axis=1)
    points[..., :2] += moves[:, :, None]
    return [Manifold.hull_points(np.ascontiguousarray(each.reshape(-1, 3))) for each in points]


def wall_distance(points: Floats, walls: PartWalls, reach: float, slack: float) -> tuple[Floats, Floats]:
    """Return the horizontal distance of each point to the nearest wall on whose outer side it is.

    A support below a face may be flush with the wall next to it. Therefore points within `slack` of the plane of a wall
    are on neither side of it, and walls end `slack` above their lowest and below their highest corner.

    Parameters
    ----------
    points
        ``(n, 3)`` mm.
    walls
        The walls.
    reach
        Largest distance that is searched, mm.
    slack
        Tolerance, mm.

    Returns
    -------
    away, foot
        ``(n,)`` distance, mm, infinite where no wall is within reach; ``(n, 3)`` nearest point on the wall.
    """
    from amprep.kernels.meshes.walls import PointGrid, nearest_walls

    away, foot = np.full(len(points), np.inf), points.copy()
    if not len(points) or not len(walls.corners):
        return away, foot
    corner = points[:, :2].min(axis=0)
    plan = points[:, :2] - corner
    side = max(reach, float(np.sqrt(np.ptp(plan, axis=0).prod() / (len(points) + 1))), 1e-3)
    column = (plan // side).astype(np.int64)
    nx, ny = (int(each) + 1 for each in column.max(axis=0))
    square = column[:, 1] * nx + column[:, 0]
    order = np.argsort(square, kind="stable")
    first = np.searchsorted(square[order], np.arange(nx * ny + 1))
    shift = np.append(corner, 0.0)
    found, place = away.copy(), np.zeros((len(points), 2))
    grid = PointGrid(points[order] - shift, first, side, (ny, nx))
    nearest_walls(grid, walls.corners - shift, walls.outward, reach, slack, found, place)
    away[order] = found
    foot[order, :2] = place + corner
    return away, foot
