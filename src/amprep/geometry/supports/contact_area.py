"""Measure the contact of supports with a part: the surface of the part inside them."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import MeshArrays
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.meshes.topology import merge_equal_vertices

if TYPE_CHECKING:
    from manifold3d import Manifold


class ContactArea(NamedTuple):
    """Area of the surface of a part inside supports, mm2, and the number of its connected patches."""

    area: float
    patches: int


def measure_contact(support: MeshArrays, part: MeshArrays) -> ContactArea:
    """Return the contact of a closed support with a closed part.

    manifold3d records for each triangle of the intersection from which solid it comes, so the area is exact.
    Supports that touch a part without entering it have no contact.
    """
    corners = contact_corners(*(as_manifold(*mesh) for mesh in (support, part)))
    if not len(corners):
        return ContactArea(0.0, 0)
    points, own = merge_equal_vertices(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    sides = points[own[:, 1:]] - points[own[:, :1]]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2.0
    return ContactArea(float(area), label_shells(own, len(points))[0])


def contact_corners(support: "Manifold", part: "Manifold") -> NDArray[np.float64]:
    """Return the triangles ``(t, 3, 3)`` mm of the surface of a part inside a support, oriented as in the part."""
    two = part.as_original()
    mesh = (support.as_original() ^ two).to_mesh64()
    triangles = np.asarray(mesh.tri_verts, np.int64)
    run = np.searchsorted(np.asarray(mesh.run_index), 3 * np.arange(len(triangles)), side="right") - 1
    own = np.asarray(mesh.run_original_id)[run] == two.original_id() if len(triangles) else []
    return np.asarray(mesh.vert_properties, np.float64)[:, :3][triangles[np.asarray(own, np.bool_)]]
