"""Judge connectors: above every connected red square a support touches the part."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model.build import Build, SupportBody
from amprep.model.mesh import Mesh

if TYPE_CHECKING:
    from manifold3d import Manifold

PROMISE = "connector touches its part"

_SLACK = 1e-6
"""Distance (mm) from a box within which points count as inside it."""


def check_contacts(build: Build, lo: Floats, hi: Floats, part: Ints) -> list[Violation]:
    """Return a violation for each column above a connected red square in which no support enters the part.

    Supports enter parts by the overlap, so a column without a common volume has no contact. A column that contains a
    listed unsupported point is excused. Walls without thickness have no volume, so parts that they hold are not judged.

    Parameters
    ----------
    build
        The build with its supports.
    lo, hi
        ``(m, 3)`` mm, corners of the columns, from the red square up to the greatest height of its connector.
    part
        ``(m,)`` index of the placed part that each red square supports.
    """
    found = []
    for index, placed in enumerate(build.parts):
        walls = any(body.surface and index in body.parts for body in build.supports)
        own = np.flatnonzero((part == index) & (not walls))
        common = _common(build.supports, placed.mesh, index) if len(own) else []
        listed = [each.points for each in build.unsupported if each.part == index]
        for number in own.tolist():
            box = lo[number], hi[number] + (0.0, 0.0, build.settings.overlap)
            if _volume(common, *box) <= 0.0 and not any(_within(points, *box).any() for points in listed):
                where = place_words(lo[number], 3)
                message = f"no connector touches the part above the end of the support at {where} mm"
                found.append(Violation(PROMISE, placed.label, message))
    return found


def _common(bodies: Sequence[SupportBody], mesh: Mesh, part: int) -> list["Manifold"]:
    """Return the intersection of each support that holds a part with that part."""
    solid = as_manifold(mesh.vertices, mesh.triangles)
    held = [body.mesh for body in bodies if part in body.parts]
    return [as_manifold(each.vertices, each.triangles) ^ solid for each in held]


def _volume(solids: Sequence["Manifold"], lo: Floats, hi: Floats) -> float:
    from manifold3d import Manifold

    box = Manifold.cube((hi - lo).tolist()).translate(lo.tolist())
    return float(sum((solid ^ box).volume() for solid in solids))


def _within(points: Floats, lo: Floats, hi: Floats) -> Bools:
    return np.asarray(((points >= lo - _SLACK) & (points <= hi + _SLACK)).all(axis=1))
