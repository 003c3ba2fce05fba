"""Faces of a part that restrict its orientation, by colour, by the name of a region, or by direction as drawn."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools
from amprep.errors import JobError, nearest_hint
from amprep.model.mesh import Mesh
from amprep.model.orientation import OrientationRules
from amprep.model.part import Part
from amprep.overhangs.conditions import colours_of
from amprep.overhangs.paint import painted_triangles

_SIDES = {
    f"{sign}{axis}": (1.0 if sign == "+" else -1.0, "xyz".index(axis)) for sign in "+-" for axis in "xyz"
}

_WITHIN_DEG = 1.0
"""Largest angle between the normal of a face and the axis that it looks along."""


class FaceMasks(NamedTuple):
    """Triangles ``(m,)`` bool that nothing may touch, that must look up, and that must look down."""

    no_contact: Bools
    up: Bools
    down: Bools


def face_masks(part: Part, mesh: Mesh, rules: OrientationRules) -> FaceMasks:
    """Return the triangles of a mesh of a part that restrict its orientation.

    Parameters
    ----------
    part
        The part.
    mesh
        Its mesh in part coordinates, perhaps with subdivided triangles.
    rules
        The rules that name the faces.

    Raises
    ------
    JobError
        When the part has no faces of a name.
    """
    return FaceMasks(
        *(_named(part, mesh, names) for names in (rules.no_contact, rules.face_up, rules.face_down))
    )


def _named(part: Part, mesh: Mesh, names: Sequence[str]) -> Bools:
    found = np.zeros(len(mesh.triangles), np.bool_)
    for name in names:
        chosen = faces_named(part, mesh, name)
        if not chosen.any():
            known = sorted({*_SIDES, *colours_of(part)})
            raise JobError(
                f"part {part.name!r} has no faces called {name!r}{nearest_hint(name, known)}; name a colour, a region, "
                "or a direction such as +x in which flat faces look as drawn"
            )
        found |= chosen
    return found


def faces_named(part: Part, mesh: Mesh, name: str) -> Bools:
    """Tell which triangles ``(m,)`` of a mesh of the part have a name; none if the name is unknown."""
    if name in _SIDES:
        sign, axis = _SIDES[name]
        corners = mesh.vertices[mesh.triangles]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        size = np.linalg.norm(cross, axis=1)
        return np.asarray((size > 0.0) & (sign * cross[:, axis] >= np.cos(np.radians(_WITHIN_DEG)) * size))
    colour = name.lower() if name.startswith("#") else name
    if colour not in colours_of(part):
        return np.zeros(len(mesh.triangles), np.bool_)
    return painted_triangles(part, mesh, colour)
