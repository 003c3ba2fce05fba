"""Join the bodies of a mesh that touch face to face, so that the faces between them are inside the solid."""

import itertools
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Ints, MeshArrays
from amprep.geometry.meshes.manifold import accepted, as_manifold

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

# Strategy. Drawings often consist of bodies that stand on one another and were never united: a level downward face is
# at the height of a level upward one. Where the two cover each other in plan, a slab as thick as a few tolerances is
# put between the bodies, and all are united. A slab overlaps both bodies, so that the union is no borderline case as it
# would be for faces that touch, and it closes gaps up to the tolerance.

_LEVEL = 1e-4
"""Heights (mm) that differ by less belong to the same level face."""

_LEAST_AREA = 1e-6
"""Area (mm2) below which common areas are rounding errors."""

_ROUNDING = 1e-5
"""Tolerance (mm) for the removal of the narrow faces that rounding leaves at the sides of slabs."""


def join_touching(vertices: Floats, triangles: Ints) -> MeshArrays | None:
    """Return a closed mesh whose bodies are joined where level faces touch, or None if none do.

    Faces up to `CONTACT_TOLERANCE` apart touch. None is returned as well if manifold3d rejects the mesh as a solid.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``, normals out of the solid.
    """
    from manifold3d import Manifold, OpType

    slabs = _slabs(vertices[triangles])
    if not slabs:
        return None
    solid = as_manifold(vertices, triangles)
    if not accepted(solid):
        return None
    mesh = Manifold.batch_boolean([solid, *slabs], OpType.Add).simplify(_ROUNDING).to_mesh64()
    return np.asarray(mesh.vert_properties[:, :3], np.float64), np.asarray(mesh.tri_verts, np.int64)


def _slabs(corners: Floats) -> list["Manifold"]:
    """Return a slab for each height at which level faces of a mesh ``(m, 3, 3)`` touch."""
    from manifold3d import Manifold

    found = []
    down, up = (_by_height(corners[each]) for each in _level_faces(corners))
    (down_height, up_height) = (each[:, 0, 2] for each in (down, up))
    for first, end in _groups(down_height):
        low, high = down_height[first], down_height[end - 1]
        start = np.searchsorted(up_height, low - CONTACT_TOLERANCE - _LEVEL)
        below = up[start : np.searchsorted(up_height, high + _LEVEL)]
        common = _common(down[first:end], below)
        if common is not None:
            bottom = float(below[0, 0, 2]) - CONTACT_TOLERANCE
            slab = Manifold.extrude(common, float(high) + CONTACT_TOLERANCE - bottom)
            found.append(slab.translate((0.0, 0.0, bottom)))
    return found


def _level_faces(corners: Floats) -> tuple[Bools, Bools]:
    """Tell which faces are level and face downwards, and which are level and face upwards."""
    a, b = (corners[:, i, :2] - corners[:, 0, :2] for i in (1, 2))
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    level = np.ptp(corners[:, :, 2], axis=1) <= _LEVEL
    return level & (area < 0), level & (area > 0)


def _by_height(corners: Floats) -> Floats:
    return corners[np.argsort(corners[:, 0, 2], kind="stable")]


def _groups(height: Floats) -> list[tuple[int, int]]:
    """Return first and end of each group in sorted heights that differ by at most `_LEVEL` from the next."""
    bounds = [*np.flatnonzero(np.diff(height, prepend=-np.inf) > _LEVEL).tolist(), len(height)]
    return list(itertools.pairwise(bounds))


def _common(above: Floats, below: Floats) -> "CrossSection | None":
    """Return the region of the plane that both of two sets of triangles ``(k, 3, 3)`` cover, if there is any."""
    above, below = _near(above, below), _near(below, above)
    if not len(above) or not len(below):
        return None
    common = _outline(above) ^ _outline(below)
    return common if common.area() > _LEAST_AREA else None


def _near(corners: Floats, others: Floats) -> Floats:
    """Return the triangles that the bounding box of others overlaps in plan."""
    if not len(others):
        return others
    lo, hi = others[:, :, :2].min(axis=(0, 1)), others[:, :, :2].max(axis=(0, 1))
    near = (corners[:, :, :2].min(axis=1) < hi).all(axis=1) & (corners[:, :, :2].max(axis=1) > lo).all(axis=1)
    return np.asarray(corners[near])


def _outline(corners: Floats) -> "CrossSection":
    """Return the region of the plane that triangles ``(k, 3, 3)`` cover."""
    from manifold3d import CrossSection, FillRule

    return CrossSection([np.ascontiguousarray(each[:, :2]) for each in corners], FillRule.NonZero)
