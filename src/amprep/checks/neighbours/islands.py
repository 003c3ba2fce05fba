"""Judge whether every component of a support leads to a part that the support holds."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.meshes.topology import drop_unused_vertices, merge_equal_vertices
from amprep.model.build import Build, SupportBody
from amprep.model.control import Stop
from amprep.model.counting import counted
from amprep.model.mesh import Mesh
from amprep.overhangs.contacts import NUDGE

if TYPE_CHECKING:
    from manifold3d import Manifold

PROMISE = "support holds its part"

_NEGLIGIBLE = 1e-4
"""Volume (mm3) up to which a component is a sliver that Booleans left, or bounds a void."""

_FIRST = 32
"""Number of the highest vertices of a component that are tried before all others."""


def check_islands(build: Build, stop: Stop, solids: KnownSolids | None = None) -> list[Violation]:
    """Return the supports with components that touch none of their parts.

    A component touches a part if one of its vertices, or the point slightly above or below it, is inside the part, or
    if its surface comes near that of the part. Components that share a point are one. Walls without thickness, beams,
    and supports of parts that are no solids are not judged. `solids` are shared with other judges.
    """
    found: list[Violation] = []
    solids = solids or KnownSolids()
    for body in build.supports:
        if stop():
            return found
        of_solids = all(build.parts[part].part.is_solid for part in body.parts)
        if not body.surface and body.lattice is None and of_solids and len(body.mesh.triangles):
            found += _judged(body, [build.parts[part].mesh for part in body.parts], build, solids)
    return found


def _judged(body: SupportBody, parts: Sequence[Mesh], build: Build, solids: KnownSolids) -> list[Violation]:
    points, triangles = body.mesh.arrays
    count, shell = solids.shells_of(body.mesh)
    if not len(_suspects(points, triangles, count, shell, parts)):
        return []
    points, triangles = merge_equal_vertices(np.round(points, 4), triangles)
    count, shell = label_shells(triangles, len(points))
    suspects = _suspects(points, triangles, count, shell, parts).tolist()
    held = [as_manifold(part.vertices, part.triangles) for part in parts]
    own = [triangles[shell == each] for each in suspects]
    places = [points[each].reshape(-1, 3)[0] for each in own if not _meets(points, each, held)]
    if not places:
        return []
    names = " or ".join(build.parts[part].label for part in body.parts)
    message = (
        f"{counted(len(places), 'component')} without contact to {names}, one at {place_words(places[0])} mm"
    )
    return [Violation(PROMISE, body.name, message)]


def _suspects(points: Floats, triangles: Int64s, count: int, shell: Int64s, parts: Sequence[Mesh]) -> Int64s:
    """Return the components with a volume of which no vertex is in or beside a part."""
    component = np.full(len(points), count)
    component[triangles] = shell[:, None]
    order = np.lexsort((-points[:, 2], component))
    start = np.searchsorted(component[order], np.arange(count + 1))
    rank = np.arange(len(order)) - start[component[order]]
    touching = np.zeros(count + 1, np.bool_)
    touching[count] = True  # vertices of no triangle
    touching[np.flatnonzero(_volumes(points, triangles, shell, count) <= _NEGLIGIBLE)] = True
    for chosen in (rank < _FIRST, rank >= _FIRST):
        some = order[chosen & ~touching[component[order]]]
        touching[component[some[_touch(points[some], parts)]]] = True
    return np.flatnonzero(~touching)


def _touch(points: Floats, parts: Sequence[Mesh]) -> Bools:
    found = np.zeros(len(points), np.bool_)
    for mesh in parts:
        for up in (NUDGE, 0.0, -NUDGE):
            left = np.flatnonzero(~found)
            found[left] = inside(points[left] + (0.0, 0.0, up), mesh.vertices, mesh.triangles)
    return found


def _meets(points: Floats, triangles: Int64s, parts: "Sequence[Manifold]") -> bool:
    """Tell whether a component meets a part anywhere, or comes within `NUDGE` of it."""
    component = as_manifold(*drop_unused_vertices(points, triangles))
    return any(component.min_gap(part, 2.0 * NUDGE) <= NUDGE for part in parts)


def _volumes(points: Floats, triangles: Int64s, shell: Int64s, count: int) -> Floats:
    """Return the signed volume (mm3) of each component."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    middle = points[triangles[:, 0]].mean(axis=0)
    six = np.einsum("ij,ij->i", a - middle, np.cross(b - middle, c - middle))
    return np.asarray(np.bincount(shell, six / 6.0, count), np.float64)
