"""Cells: connected parts of a solid between cutting planes, with their convex hulls."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s

if TYPE_CHECKING:
    from manifold3d import Manifold

SLIVER = 1e-7
"""Triangles smaller than this fraction of the largest have no reliable normal."""


@dataclass(frozen=True, eq=False)
class CutCell:
    """A connected solid without cavities.

    Attributes
    ----------
    solid
        The solid.
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``, its mesh.
    corners
        ``(k, 3)`` mm, corners of its convex hull.
    excess
        Volume of the hull less that of the solid, mm3.
    """

    solid: "Manifold"
    vertices: Floats
    triangles: Int64s
    corners: Floats
    excess: float


def cells_of(solid: "Manifold") -> list[CutCell]:
    """Return the connected components of a solid as cells. Cavities are filled: no other part can get there."""
    return [_cell(component) for component in solid.decompose() if component.volume() > 0.0]


def _cell(solid: "Manifold") -> CutCell:
    mesh, hull = solid.to_mesh64(), solid.hull()
    vertices = np.ascontiguousarray(mesh.vert_properties[:, :3])
    corners = np.ascontiguousarray(hull.to_mesh64().vert_properties[:, :3])
    excess = hull.volume() - solid.volume()
    return CutCell(solid, vertices, mesh.tri_verts.astype(np.int64), corners, excess)


def edges_of(triangles: Int64s) -> Int64s:
    """Return the edges ``(e, 2)`` of a closed mesh, each once, the lower vertex first."""
    following = np.roll(triangles, -1, axis=1)
    rising = triangles < following
    return np.column_stack((triangles[rising], following[rising]))


def hull_volume(points: Floats) -> float:
    """Return the volume of the convex hull of points ``(n, 3)``, accurate to 1e-7 of their size."""
    from manifold3d import Manifold

    return float(Manifold.hull_points(points).volume())


def hull_planes(points: Floats) -> Floats:
    """Return the planes ``(k, 4)`` of the convex hull of points ``(n, 3)``; none if they are in one plane."""
    from manifold3d import Manifold

    mesh = Manifold.hull_points(points).to_mesh64()
    corners = mesh.vert_properties[:, :3][mesh.tri_verts]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    wide = length > SLIVER * length.max(initial=0.0)
    normals = normals[wide] / length[wide, None]
    return np.column_stack((normals, np.einsum("ij,ij->i", normals, corners[wide, 0])))


def hull_corners(points: Floats) -> Floats:
    """Return the corners of the convex hull of points ``(n, 3)``, accurate to 1e-7 of their size."""
    from manifold3d import Manifold

    found = Manifold.hull_points(points).to_mesh64().vert_properties[:, :3]
    return np.ascontiguousarray(found) if len(found) else points
