"""Bounding volumes, which packers place instead of the parts; all in part coordinates, mm."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.model.mesh import Mesh

if TYPE_CHECKING:
    from amprep.geometry.trees.collision_mesh import CollisionMesh


@dataclass(frozen=True, eq=False)
class Boxes:
    """Axis-parallel boxes in fixed relative position whose union contains the part.

    Attributes
    ----------
    lo, hi
        ``(k, 3)`` corners.
    """

    lo: Floats
    hi: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "lo", frozen(self.lo, np.float64, 3))
        object.__setattr__(self, "hi", frozen(self.hi, np.float64, 3))

    def enclosing(self) -> tuple[Floats, Floats]:
        """Least and greatest corner of the enclosing box, each ``(3,)``."""
        return self.lo.min(axis=0), self.hi.max(axis=0)


@dataclass(frozen=True, eq=False)
class ConvexPieces:
    """Closed convex meshes whose union contains the part."""

    pieces: tuple[Mesh, ...]

    def enclosing(self) -> tuple[Floats, Floats]:
        """Least and greatest corner of the enclosing box, each ``(3,)``."""
        bounds = [piece.bounds for piece in self.pieces]
        return np.min([lo for lo, _ in bounds], axis=0), np.max([hi for _, hi in bounds], axis=0)


@dataclass(frozen=True, eq=False)
class Solid:
    """A closed mesh that contains the part, or the mesh of the part itself."""

    mesh: Mesh

    @cached_property
    def collision_mesh(self) -> "CollisionMesh":
        """The triangles with their OBB tree; built at the first use, and shared by all placements of this volume."""
        from amprep.geometry.trees.collision_mesh import collision_mesh

        return collision_mesh(*self.mesh.arrays)

    def enclosing(self) -> tuple[Floats, Floats]:
        """Least and greatest corner of the enclosing box, each ``(3,)``."""
        return self.mesh.bounds


BoundingVolume = Boxes | ConvexPieces | Solid


@dataclass(frozen=True, eq=False)
class TurnedVolume:
    """A bounding volume in an orientation that its maker chose (thesis 2.3, coverings of a part that may be rotated).

    Attributes
    ----------
    volume
        Contains the part after its rotation by `rotation` about the origin of the part.
    rotation
        ``(3, 3)`` the identity, or one of the orientations that the part allows.
    bound, gap
        Proven lower bound (mm3) on the volume of every covering among which the maker chose, and how far it is below
        the best one that it found among them, as a fraction of that one; None if it proves none. A maker that chooses
        among coverings of a grid may refine the best one below that bound.
    """

    volume: BoundingVolume
    rotation: Floats
    bound: float | None = None
    gap: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "rotation", frozen(self.rotation, np.float64).reshape(3, 3))


def as_turned(made: "BoundingVolume | TurnedVolume") -> TurnedVolume:
    """Return what a volume maker returned as a turned volume; a plain volume is turned by the identity."""
    return made if isinstance(made, TurnedVolume) else TurnedVolume(made, np.eye(3))
