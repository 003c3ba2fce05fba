"""Cut drain holes into finished supports that would trap powder, for cells that promise to release it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Int64s, MeshArrays
from amprep.geometry.merging.union import arrays_of, evaluated
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.powder.drain_holes import find_drain_holes
from amprep.model import Mesh
from amprep.supports.solids.keep_out import find_grounded

if TYPE_CHECKING:
    from manifold3d import Manifold

_ROUNDS = 4
"""Largest number of rounds; a drain hole may end in another pocket, which the next round opens."""

_CRUMB = 1e-3
"""Largest volume (mm3) of a piece that may lose its connection to the plate by a drain hole."""

_TRIES = 4
"""Largest number of times that holes are left out because a piece would float."""

_Hole = tuple[Floats, Floats]
"""Least and greatest corner of a hole, mm."""

# Strategy. A hole may cut a piece off from all that stands. Such a piece has vertices where the hole cut it, so the
# holes that it owes its loss to are those that contain a vertex of it. They are left out; the others are cut again,
# and what they leave is more than before, so that a second try is nearly always the last. All is found on the arrays of
# the solid that was cut, of which each component is judged by itself.


class _SupportComponents(NamedTuple):
    """The components of a support.

    Attributes
    ----------
    points, triangles
        The support as a closed mesh.
    component
        ``(m,)`` component of each triangle.
    stands
        ``(k,)`` whether a component stands, on the plate or on a part.
    """

    points: Floats
    triangles: Int64s
    component: Int64s
    stands: Bools

    @staticmethod
    def of(solid: "Manifold", boxes: tuple[Floats, Floats]) -> "_SupportComponents":
        """Return the components of a solid."""
        arrays = arrays_of(solid)
        return _SupportComponents(*arrays, *find_grounded(*arrays, boxes))

    @property
    def grounded(self) -> MeshArrays:
        """Closed mesh of the components that stand."""
        if self.stands.all():
            return self.points, self.triangles
        return drop_unused_vertices(self.points, self.triangles[self.stands[self.component]])

    @property
    def floating_vertices(self) -> Int64s:
        """Vertices of the components that float."""
        return np.unique(self.triangles[~self.stands[self.component]])


def cut_drain_holes(
    solid: "Manifold",
    parts: Sequence[Mesh],
    diameter: float,
    boxes: tuple[Floats, Floats],
) -> tuple["Manifold", tuple[Floats, Floats]]:
    """Cut drain holes for a ball into a support, wherever short straight holes exist.

    Parameters
    ----------
    solid
        The support; pieces of it that float stay.
    parts
        Parts that the support holds.
    diameter
        Diameter (mm) of the ball that must be able to escape.
    boxes
        Least and greatest corners ``(k, 3)`` of the boxes in which feet on parts end.

    Returns
    -------
    solid, holes
        The support, and the least and greatest corners ``(n, 3)`` mm of the holes.
    """
    around = [(part.vertices, part.triangles) for part in parts]
    pieces = _SupportComponents.of(solid, boxes)
    done: list[_Hole] = []
    refused: set[bytes] = set()
    for _ in range(_ROUNDS):
        grounded = pieces.grounded
        found = find_drain_holes(grounded, around, diameter) if len(grounded[1]) else []
        holes = [hole for hole in found if _key(hole) not in refused]
        tried = _cut(solid, pieces, holes, boxes)
        kept = set() if tried is None else {_key(hole) for hole in tried.holes}
        refused.update({_key(hole) for hole in holes} - kept)
        if tried is None:
            break
        solid, pieces = tried.solid, tried.pieces
        done += tried.holes
    low, high = np.array(done).reshape(-1, 2, 3).swapaxes(0, 1)
    return solid, (low, high)


class _Opened(NamedTuple):
    """A support with holes, its components, and the holes."""

    solid: "Manifold"
    pieces: _SupportComponents
    holes: list[_Hole]


def _cut(
    solid: "Manifold", before: _SupportComponents, holes: list[_Hole], boxes: tuple[Floats, Floats]
) -> _Opened | None:
    """Cut holes into a support, apart from those by which a piece would lose its connection to the plate.

    Crumbs do not count, nor do pieces that stood by touching others at a vertex, away from all holes. None if no hole
    is left.
    """
    from manifold3d import Manifold, OpType

    for _ in range(_TRIES):
        if not holes:
            break
        cuts = [Manifold.cube((hi - lo).tolist()).translate(lo.tolist()) for lo, hi in holes]
        opened = evaluated(solid - Manifold.batch_boolean(cuts, OpType.Add))
        after = _SupportComponents.of(opened, boxes)
        lost = _lost_vertices(before, after)
        harmless = [hole for hole in holes if not _is_in(lost, hole).any()]
        if len(harmless) == len(holes):
            return _Opened(opened, after, holes)
        holes = harmless
    return None


def _lost_vertices(before: _SupportComponents, after: _SupportComponents) -> Floats:
    """Return the vertices ``(k, 3)`` mm of the components that float after a cut, but are of one that stood before."""
    loose = ~after.stands[after.component]
    triangles, component = after.triangles[loose], after.component[loose]
    volume = np.bincount(component, np.linalg.det(after.points[triangles]), len(after.stands)) / 6.0
    floated = {point.tobytes() for point in before.points[before.floating_vertices]}
    found = [np.empty((0, 3))]
    for piece in np.flatnonzero(volume > _CRUMB):
        points = after.points[np.unique(triangles[component == piece])]
        if not any(point.tobytes() in floated for point in points):
            found.append(points)
    return np.concatenate(found)


def _is_in(points: Floats, hole: _Hole) -> Bools:
    """Tell which points ``(k, 3)`` mm are in a hole or on its border."""
    low, high = hole[0] - CONTACT_TOLERANCE, hole[1] + CONTACT_TOLERANCE
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))


def _key(hole: _Hole) -> bytes:
    return np.concatenate(hole).tobytes()
