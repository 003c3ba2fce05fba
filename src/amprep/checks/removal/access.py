"""Judge whether the contacts of supports can be reached by a straight tool from outside the part."""

from collections.abc import Sequence
from itertools import product
from math import gcd

import numpy as np

from amprep.arrays import Floats
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.containment import inside
from amprep.model.build import Build, SupportBody
from amprep.model.control import Stop
from amprep.model.mesh import Mesh

PROMISE = "contacts can be reached"
"""Name of the promise."""

_AWAY = 0.5
"""Distance (mm) from a contact at which the tool begins."""

_MOST_CONTACTS = 64
"""Largest number of contacts of a support that are judged, evenly chosen."""

DIRECTIONS = np.array([each for each in product(range(-2, 3), repeat=3) if gcd(*each) == 1], np.float64)
"""The 98 directions with coordinates up to 2; the part is off the plate when supports are removed."""

# Strategy. The vertices of a support inside a part are its contacts. From a point beside each, outside all parts that
# the support holds, rays in 98 directions look for the outside; other supports do not count, because they are removed
# as well, and other parts do not, because they are taken away before. A bent tool may still reach what this calls
# hidden, so it is one thing to check, not a proof.


def check_access(build: Build, stop: Stop) -> list[Violation]:
    """Return the supports with contacts that no straight line from outside reaches."""
    found = []
    for body in build.supports:
        if stop():
            break
        hidden, judged = hidden_contacts(build, body)
        if len(hidden):
            message = (
                f"{len(hidden)} of {judged} judged contacts cannot be reached by a straight tool, for example at "
                f"{place_words(hidden[0])} mm"
            )
            found.append(Violation(PROMISE, body.name, message))
    return found


def hidden_contacts(build: Build, body: SupportBody) -> tuple[Floats, int]:
    """Return the contacts ``(k, 3)`` mm of a support that no straight line reaches, and how many were judged."""
    from amprep.kernels.meshes.line_of_sight import look_outside

    parts = [build.parts[index].mesh for index in body.parts]
    vertices = body.mesh.vertices
    within = np.zeros(len(vertices), np.bool_)
    for part in parts:
        within |= inside(vertices, part.vertices, part.triangles)
    contacts = vertices[within]
    if not len(contacts):
        return contacts, 0
    contacts = contacts[np.unique(np.linspace(0, len(contacts) - 1, _MOST_CONTACTS).astype(np.int64))]
    beside = _beside(contacts, parts)
    judged = np.isfinite(beside[:, 0])
    contacts, beside = contacts[judged], beside[judged]
    corners = np.concatenate([part.vertices[part.triangles] for part in parts])
    sees = np.zeros(len(beside), np.bool_)
    look_outside(np.ascontiguousarray(beside), DIRECTIONS, np.ascontiguousarray(corners), sees)
    return contacts[~sees], len(contacts)


def _beside(contacts: Floats, parts: Sequence[Mesh]) -> Floats:
    """Return a point below each contact, or above it, that is outside the parts ``(n, 3)`` mm; NaN for none."""
    result = np.full_like(contacts, np.nan)
    for way in (-1.0, 1.0):
        points = contacts + (0.0, 0.0, way * _AWAY)
        outside = np.isnan(result[:, 0])
        for part in parts:
            outside &= ~inside(points, part.vertices, part.triangles)
        result[outside] = points[outside]
    return result
