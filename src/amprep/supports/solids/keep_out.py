"""Keep supports out of parts and away from their walls, and drop the pieces that float or hold nothing then."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.merging.union import arrays_of, union
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.supports.contact_area import contact_corners
from amprep.geometry.supports.walls import occupancy_of, spaces_beside, walls_of
from amprep.model import CONTACT_TOLERANCE, Mesh, PlacedPart, SupportBody
from amprep.supports.layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import Manifold

_CRUMB = 1e-4
"""Volume (mm3) of a void up to which it is a leftover of rounding, and is filled."""

_NARROW = 0.2
"""Mean width (mm) of a void below which it is filled: powder in it would melt with its walls."""

_HIGHEST = 16
"""Number of the highest vertices of a piece that are tried before all others: most pieces hold a part there."""


class WallClearance:
    """The walls of all parts of a build, and the XY distance that supports keep from them.

    Routing closes the voxels within this distance, except in the columns of connectors and directly below them.
    """

    def __init__(self, layout: SupportLayout, gap: float, overlap: float) -> None:
        self._gap = gap
        stood_on = set(layout.feet[:, 3].tolist())
        self._walls = [
            walls_of(mesh.vertices, mesh.triangles, overhangs, overlap, stood_on=part in stood_on)
            for part, (mesh, overhangs) in enumerate(layout.overhangs)
        ]

    def clip(self, solid: "Manifold") -> "Manifold":
        """Return a solid without its points that are nearer to a wall than the XY distance."""
        from manifold3d import Manifold, OpType

        if solid.is_empty():
            return solid
        points, triangles = arrays_of(solid)
        corners = points[triangles]
        taken = occupancy_of(corners.min(axis=1), corners.max(axis=1))
        cutters: list[Manifold] = []
        for walls in self._walls:
            cutters += spaces_beside(walls.chosen(taken.near(walls.corners, self._gap)), self._gap)
        return solid - Manifold.batch_boolean(cutters, OpType.Add) if cutters else solid


class PartObstacles:
    """The solid parts of a build, and supports that are finished, as obstacles.

    manifold3d orders the vertices of a result by the ages of its operands. So the solids are made at once: whatever
    support is built first, they are older than it.
    """

    def __init__(
        self,
        parts: Sequence[PlacedPart],
        clearance: WallClearance | None = None,
        finished: Sequence[SupportBody] = (),
    ) -> None:
        self._finished = [each.mesh for each in finished if not each.surface]
        self._finished_solids = [as_manifold(*mesh.arrays) for mesh in self._finished]
        self._meshes = {index: placed.mesh for index, placed in enumerate(parts) if placed.part.is_solid}
        self._clearance = clearance
        self._solids = {index: as_manifold(*mesh.arrays) for index, mesh in self._meshes.items()}

    def subtract_from(
        self, connectors: "Manifold", held: tuple[int, ...], overlap: float, *, down: bool = False
    ) -> "Manifold":
        """Subtract finished supports, and the parts down to the permitted depth in those that connectors hold.

        Depth is measured vertically: a point is too deep when the point `overlap` below it (above it for feet) is in
        the part too. Subtracting the part shifted by the overlap removes exactly the points that are too deep.

        Parameters
        ----------
        connectors
            Connectors, or feet.
        held
            Parts that may be entered by the overlap; other parts must not be entered.
        overlap
            Permitted depth, mm.
        down
            True for feet, which enter parts from above.
        """
        for index in _meeting(connectors, self._meshes):
            depth = overlap if index in held else 0.0
            # half the contact tolerance more, so that faces that should just touch do not intersect
            shift = depth + CONTACT_TOLERANCE / 2
            connectors -= self._solids[index].translate((0.0, 0.0, -shift if down else shift))
        for index in _meeting(connectors, dict(enumerate(self._finished))):
            connectors -= self._finished_solids[index]
        return connectors

    def clip(self, solids: list["Manifold"]) -> list["Manifold"]:
        """Return solids without their points that are nearer to walls of parts than the XY distance."""
        if self._clearance is None or not solids:
            return solids
        return [self._clearance.clip(union(solids))]

    def near(self, solid: "Manifold") -> list["Manifold"]:
        """Return the solid parts whose boxes meet that of a solid."""
        return [self._solids[index] for index in _meeting(solid, self._meshes)]

    def contact(self, connectors: "Manifold", held: tuple[int, ...]) -> Floats:
        """Return the triangles ``(t, 3, 3)`` mm of the held parts inside the connectors."""
        found = [np.empty((0, 3, 3))]
        found += [
            contact_corners(connectors, self._solids[index])
            for index in _meeting(connectors, self._meshes)
            if index in held
        ]
        return np.concatenate(found)


def _meeting(solid: "Manifold", meshes: Mapping[int, Mesh]) -> list[int]:
    """Return the numbers of the meshes whose bounding boxes meet that of a solid."""
    lo, hi = (np.array(corner) for corner in np.split(np.array(solid.bounding_box()), 2))
    return [
        index
        for index, mesh in meshes.items()
        if (lo <= mesh.bounds[1]).all() and (hi >= mesh.bounds[0]).all()
    ]


def drop_floating(
    points: Floats, triangles: Ints, feet: tuple[Floats, Floats] | None = None
) -> tuple[Floats, Ints]:
    """Return the disconnected components of a closed mesh that stand, see `find_grounded`, with their voids."""
    shell, stays = find_grounded(points, triangles, feet)
    if stays.all():
        return points, triangles
    return drop_unused_vertices(points, triangles[stays[shell]])


def find_grounded(
    points: Floats, triangles: Ints, feet: tuple[Floats, Floats] | None = None
) -> tuple[Int64s, Bools]:
    """Tell which disconnected components of a closed mesh reach the plate or a foot, or are voids of those that do.

    Voids of less than 1e-4 mm3, which rounding leaves, and voids of a mean width of less than 0.2 mm do not count.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    feet
        Least and greatest corners ``(k, 3)`` of boxes; a component with a vertex in one of them stands on a part.

    Returns
    -------
    component, stands
        The component of each triangle ``(m,)``, and whether each component stands.
    """
    count, of_triangle = label_shells(triangles, len(points))
    shell = np.zeros(len(points), np.int64)
    shell[triangles] = of_triangle[:, None]
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, shell, points[:, 2])
    stays = lowest <= CONTACT_TOLERANCE
    loose = ~stays[of_triangle]
    if not loose.any():
        return of_triangle, stays
    corners = points[triangles[loose]]
    volume = np.bincount(of_triangle[loose], np.linalg.det(corners), count) / 6.0
    is_void = volume < -np.maximum(_CRUMB, 0.5 * _NARROW * _areas(corners, of_triangle[loose], count))
    stays |= is_void
    for low, high in zip(*(feet or ()), strict=True):
        stays[shell[((points >= low) & (points <= high)).all(axis=1)]] = True
    voids = np.flatnonzero(is_void)
    if len(voids):
        _drop_voids(stays, voids, points, shell)
    return of_triangle, stays


def drop_idle(points: Floats, triangles: Ints, parts: Sequence[Mesh]) -> tuple[Floats, Ints]:
    """Return the disconnected components of a closed mesh that touch one of the parts, with their voids.

    What is cut off at borders and thin places may leave pieces on the plate that hold nothing.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    parts
        Meshes of the parts that the support holds, which are solids.
    """
    count, of_triangle = label_shells(triangles, len(points))
    shell = np.zeros(len(points), np.int64)
    shell[triangles] = of_triangle[:, None]
    stays = np.zeros(count, np.bool_)
    order = np.lexsort((-points[:, 2], shell))
    begins = np.searchsorted(shell[order], np.arange(count))
    rank = np.arange(len(order)) - begins[shell[order]]
    for some in (order[rank < _HIGHEST], order[rank >= _HIGHEST]):
        for mesh in parts:
            left = some[~stays[shell[some]]]
            stays[shell[left[inside(points[left], mesh.vertices, mesh.triangles)]]] = True
    if stays.all():
        return points, triangles
    solids = [as_manifold(mesh.vertices, mesh.triangles) for mesh in parts]
    voids = []
    for each in np.flatnonzero(~stays).tolist():
        own = triangles[of_triangle == each]
        if np.linalg.det(points[own]).sum() < 0.0:
            voids.append(each)
            continue
        piece = as_manifold(*drop_unused_vertices(points, own))
        stays[each] = any(piece.min_gap(solid, 1.0) <= CONTACT_TOLERANCE for solid in solids)
    stays[voids] = True
    _drop_voids(stays, np.array(voids, np.int64), points, shell)
    return drop_unused_vertices(points, triangles[stays[of_triangle]])


def _areas(corners: Floats, shell: Int64s, count: int) -> Floats:
    """Return the area of each shell ``(count,)``, of triangles ``(m, 3, 3)`` mm."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.bincount(shell, np.linalg.norm(normals, axis=1), count) / 2.0


def _drop_voids(stays: Bools, voids: Int64s, points: Floats, shell: Int64s) -> None:
    """Let voids stay only inside shells that stay, `stays` ``(k,)``; `shell` ``(n,)`` is that of each point."""
    lo, hi = np.full((len(stays), 3), np.inf), np.full((len(stays), 3), -np.inf)
    np.minimum.at(lo, shell, points)
    np.maximum.at(hi, shell, points)
    solid = np.ones(len(stays), np.bool_)
    solid[voids] = False
    for void in voids:
        around = solid & (lo <= lo[void]).all(axis=1) & (hi >= hi[void]).all(axis=1)
        stays[void] = (stays & around).any()
