"""Tell which points blockers and enforcers concern, up to the uncertainty of their borders."""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.sampling import sample_triangles
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.model.part import Region, RegionKind

BORDER = 0.8
"""Uncertainty (mm) of the borders of blockers and enforcers."""


def whole_triangles(regions: tuple[Region, ...], kind: RegionKind) -> Int64s:
    """Return the triangles that regions of one kind name."""
    named = [each.triangles for each in regions if each.kind == kind and each.mesh is None]
    return np.concatenate([np.empty(0, np.int64), *(each for each in named if each is not None)])


def _volumes(placed: PlacedPart, kind: RegionKind) -> list[Mesh]:
    """Return the closed meshes of the regions of one kind, in build coordinates."""
    own = [each for each in placed.part.regions if each.kind == kind and each.triangles is None]
    return [each.mesh.moved(placed.matrix) for each in own if each.mesh is not None]


def _painted(placed: PlacedPart, kind: RegionKind, chosen: Bools | None = None) -> Floats:
    """Return the painted triangles ``(k, 3, 3)`` of one kind in build coordinates, of the chosen triangles only."""
    found = [np.empty((0, 3, 3))]
    for each in placed.part.regions:
        if each.kind == kind and each.mesh is not None and each.triangles is not None:
            mesh = each.mesh.moved(placed.matrix)
            corners = mesh.vertices[mesh.triangles]
            found.append(corners if chosen is None else corners[chosen[each.triangles]])
    return np.concatenate(found)


def enforced_points(placed: PlacedPart, down: Bools, spacing: float) -> Floats:
    """Return points ``(n, 3)`` on the downward faces that are in the middle of enforcers.

    Parameters
    ----------
    placed
        The part.
    down
        ``(m,)`` bool, triangles that face downwards.
    spacing
        Distance of the points, mm.
    """
    corners = placed.mesh.vertices[placed.mesh.triangles[down]]
    volumes = _volumes(placed, "enforcer")
    points = sample_triangles(corners, spacing) if volumes else np.empty((0, 3))
    within = np.zeros(len(points), np.bool_)
    for volume in volumes:
        within |= np.all(
            [inside(each, volume.vertices, volume.triangles) for each in _around(points)], axis=0
        )
    return np.concatenate([points[within], sample_triangles(_painted(placed, "enforcer", down), spacing)])


def border_of(placed: PlacedPart) -> float:
    """Return the distance (mm) beyond `reach` at which the planner may still place contacts of a part."""
    return BORDER if any(region.kind in ("blocker", "enforcer") for region in placed.part.regions) else 0.0


def in_blockers(points: Floats, placed: PlacedPart) -> Bools:
    """Tell which points are in a blocker or within `BORDER` of one."""
    from scipy.spatial import KDTree

    within = np.zeros(len(points), np.bool_)
    for volume in _volumes(placed, "blocker"):
        within |= np.any(
            [inside(each, volume.vertices, volume.triangles) for each in _around(points)], axis=0
        )
    painted = _painted(placed, "blocker")
    if len(painted) and len(points):
        distance, _ = KDTree(sample_triangles(painted, BORDER / 2)).query(points)
        within |= distance <= 1.5 * BORDER
    return within


def _around(points: Floats) -> list[Floats]:
    """Return the points, and the points moved by `BORDER` along each axis both ways."""
    return [points, *(points + sign * step for step in np.eye(3) * BORDER for sign in (-1.0, 1.0))]
