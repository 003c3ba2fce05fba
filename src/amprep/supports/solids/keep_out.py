"""Keeps supports out of parts: nothing of them stays deeper than the overlap, nor hangs in the air then."""

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.geometry.merging.union import arrays_of, union
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.supports.contact_area import contact_corners
from amprep.geometry.supports.walls import occupancy_of, spaces_beside, walls_of
from amprep.model import CONTACT_TOLERANCE, PlacedPart
from amprep.supports.layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import Manifold


class WallClearance:
    """The walls of all parts of a build, with the distance that supports keep from them.

    Routing closes what is nearer than the gap, except where connectors run up and right below them.
    """

    def __init__(self, layout: SupportLayout, gap: float, overlap: float) -> None:
        self._gap = gap
        stood_on = set(layout.feet[:, 3].tolist())
        self._walls = [
            walls_of(mesh.vertices, mesh.triangles, needs, overlap, stood_on=part in stood_on)
            for part, (mesh, needs) in enumerate(zip(layout.meshes, layout.overhangs, strict=True))
        ]

    def offset(self, solid: "Manifold") -> "Manifold":
        """Return what of a solid is as far from all walls as asked, measured sideways."""
        from manifold3d import Manifold, OpType

        points, triangles = arrays_of(solid)
        corners = points[triangles]
        taken = occupancy_of(corners.min(axis=1), corners.max(axis=1))
        cutters: list[Manifold] = []
        for walls in self._walls:
            cutters += spaces_beside(walls.chosen(taken.near(walls.corners, self._gap)), self._gap)
        return solid - Manifold.batch_boolean(cutters, OpType.Add) if cutters else solid


class PartObstacles:
    """The solid parts of a build, ready to be cut out of supports; each is made when first needed."""

    def __init__(self, parts: Sequence[PlacedPart], clearance: WallClearance | None = None) -> None:
        self._parts = [(index, placed.mesh) for index, placed in enumerate(parts) if placed.part.is_solid]
        self._clearance = clearance
        self._solid = cache(lambda index: as_manifold(*self._arrays(index)))

    def _arrays(self, index: int) -> tuple[Floats, Ints]:
        mesh = dict(self._parts)[index]
        return mesh.arrays

    def subtract_from(
        self, connectors: "Manifold", held: tuple[int, ...], overlap: float, *, down: bool = False
    ) -> "Manifold":
        """Return what of the connectors lies at most `overlap` mm deep in parts they hold, and in no other.

        Depth is measured upwards, or `down` for feet: a point is too deep when the point `overlap` before it
        lies in the part too.
        """
        lo, hi = (np.array(corner) for corner in np.split(np.array(connectors.bounding_box()), 2))
        for index, mesh in self._parts:
            if (lo > mesh.bounds[1]).any() or (hi < mesh.bounds[0]).any():
                continue
            depth = overlap if index in held else 0.0
            # half the tolerance apart, so that faces which should just meet do not cut each other
            shift = depth + CONTACT_TOLERANCE / 2
            connectors -= self._solid(index).translate((0.0, 0.0, -shift if down else shift))
        return connectors

    def clip(self, solids: list["Manifold"]) -> list["Manifold"]:
        """Return finished solids, cut where they come nearer to walls of parts than the clearance."""
        if self._clearance is None or not solids:
            return solids
        whole = union(solids)
        return [self._clearance.offset(whole)]

    def contact(self, connectors: "Manifold", held: tuple[int, ...]) -> Floats:
        """Return the triangles ``(t, 3, 3)`` mm of the parts held that lie in the connectors."""
        lo, hi = (np.array(corner) for corner in np.split(np.array(connectors.bounding_box()), 2))
        found = [np.empty((0, 3, 3))]
        for index, mesh in self._parts:
            if index in held and (lo <= mesh.bounds[1]).all() and (hi >= mesh.bounds[0]).all():
                found.append(contact_corners(connectors, self._solid(index)))
        return np.concatenate(found)


def drop_floating(
    points: Floats, triangles: Ints, feet: tuple[Floats, Floats] | None = None
) -> tuple[Floats, Ints]:
    """Return the pieces of a closed mesh that reach the plate or a foot, with the voids inside them.

    Parameters
    ----------
    feet
        Least and greatest corners ``(k, 3)`` of boxes: a piece with a vertex in one of them stands there.
    """
    count, shell = label_shells(triangles, len(points))
    corners = points[triangles]
    lo, hi = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(lo, shell, corners.min(axis=1))
    np.maximum.at(hi, shell, corners.max(axis=1))
    volume = np.bincount(
        shell, np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])), count
    )
    stays = (lo[:, 2] <= CONTACT_TOLERANCE) | (volume < 0.0)
    for low, high in zip(*(feet or ()), strict=True):
        stays[shell[((corners >= low) & (corners <= high)).all(axis=2).any(axis=1)]] = True
    for void in np.flatnonzero(volume < 0.0):
        around = (volume > 0.0) & (lo <= lo[void]).all(axis=1) & (hi >= hi[void]).all(axis=1)
        stays[void] = (stays & around).any()
    return drop_unused_vertices(points, triangles[stays[shell]])


if TYPE_CHECKING:
    from manifold3d import Manifold
