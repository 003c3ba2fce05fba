"""Measures where supports touch a part: the part's surface inside them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.manifolds import as_manifold
from amprep.geometry.merging import merge_equal
from amprep.geometry.shells import label_shells

Arrays = tuple[NDArray[np.float64], NDArray[np.integer]]


class Contact(NamedTuple):
    """Area of a part's surface inside supports, mm2, and into how many patches it falls."""

    area: float
    patches: int


def measure_contact(support: Arrays, part: Arrays) -> Contact:
    """Return the contact of a closed support with a closed part.

    manifold3d says of each triangle of the intersection which of the two it comes from, so the area is exact.
    Supports that touch a part without entering it have no contact.
    """
    one, two = (as_manifold(*mesh).as_original() for mesh in (support, part))
    mesh = (one ^ two).to_mesh64()
    triangles = np.asarray(mesh.tri_verts, np.int64)
    run = np.searchsorted(np.asarray(mesh.run_index), 3 * np.arange(len(triangles)), side="right") - 1
    own = (
        triangles[np.asarray(mesh.run_original_id)[run] == two.original_id()] if len(triangles) else triangles
    )
    if not len(own):
        return Contact(0.0, 0)
    points, own = merge_equal(np.asarray(mesh.vert_properties)[:, :3], own)
    sides = points[own[:, 1:]] - points[own[:, :1]]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2.0
    return Contact(float(area), label_shells(own, len(points))[0])
