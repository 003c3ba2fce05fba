"""Flatten what a build item shows: components of components, mirrored and sheared, into one mesh."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.errors import InputError
from amprep.model.mesh import Mesh
from amprep.model.part import Region, RegionKind
from amprep.threemf.read.arrays import fetch_mesh
from amprep.threemf.read.colours import Paint, paint_of
from amprep.threemf.read.painted_supports import Painted, painted_regions
from amprep.threemf.read.slicer_config import (
    BLOCKER,
    ENFORCER,
    MODIFIER,
    NEGATIVE,
    SOLID,
    Role,
    SlicerObject,
    Volume,
)

if TYPE_CHECKING:
    from lib3mf import Lib3MF

MOST_TRIANGLES = 50_000_000

_REGIONS: dict[str, RegionKind] = {BLOCKER: "blocker", ENFORCER: "enforcer", MODIFIER: "lattice"}


@dataclass
class Shape:
    """What has been gathered of a build item so far, in its own coordinates and the file's unit.

    Attributes
    ----------
    vertices, triangles
        Of each mesh, its triangles counted from its own first vertex.
    """

    vertices: list[Floats] = field(default_factory=list)
    triangles: list[NDArray[np.int64]] = field(default_factory=list)
    paints: list[Paint] = field(default_factory=list)
    regions: list[Region] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def joined(self) -> tuple[Floats, NDArray[np.int64]]:
        """Return the meshes as one."""
        first = np.cumsum([0, *(len(vertices) for vertices in self.vertices)])
        return np.concatenate(self.vertices), np.concatenate(
            [triangles + start for triangles, start in zip(self.triangles, first, strict=False)]
        )


class Gatherer:
    """Gathers the shapes of a model's objects; `where` names the file, `paint` is that of `Package`."""

    def __init__(
        self,
        model: "Lib3MF.Model",
        slicer: Mapping[int, SlicerObject],
        roles: Mapping[tuple[int, int], Role],
        paint: Mapping[tuple[str, int], Painted],
        where: str,
    ) -> None:
        self.model = model
        self.slicer = slicer
        self.roles = roles
        self.paint = paint
        self.where = where
        self._triangles = 0

    def shape_of(self, thing: "Lib3MF.Object", linear: Floats, role: Role | None = None) -> Shape:
        """Return what an object shows under the ``(3, 3)`` map `linear` (row vectors); `role` is what it is for."""
        shape = Shape()
        frame = np.eye(4)
        frame[:3, :3] = linear
        self._gather(thing, frame, role, shape)
        return shape

    def _gather(self, thing: "Lib3MF.Object", frame: Floats, role: Role | None, shape: Shape) -> None:
        skipped = _why_skipped(thing)
        if skipped:
            shape.notes.append(f"left out {thing.GetName() or 'an object'!r}: {skipped}")
        elif thing.IsMeshObject():
            self._gather_mesh(thing, frame, role, shape)
        elif thing.IsComponentsObject():
            for index in range(thing.GetComponentCount()):
                component = thing.GetComponent(index)
                inner = component.GetObjectResource()
                names = thing.GetModelResourceID(), inner.GetModelResourceID()
                with np.errstate(all="ignore"):  # what overflows is found out with the mesh
                    placed = row_matrix(component.GetTransform()) @ frame
                self._gather(inner, placed, self.roles.get(names, role), shape)
        else:
            shape.notes.append(f"left out {thing.GetName() or 'an object'!r}: it is no mesh")

    def _gather_mesh(
        self, thing: "Lib3MF.MeshObject", frame: Floats, role: Role | None, shape: Shape
    ) -> None:
        self._triangles += thing.GetTriangleCount()
        if self._triangles > MOST_TRIANGLES:
            raise InputError(
                f"{self.where}: more than {MOST_TRIANGLES} triangles in the build; split the job"
            )
        raw = fetch_mesh(thing)
        if not np.abs(frame).max() < 1e30:
            raise InputError(
                f"{self.where}: the transform of {thing.GetName()!r} is not made of usable numbers"
            )
        turns = np.linalg.det(frame[:3, :3])
        if turns == 0.0:
            raise InputError(f"{self.where}: {thing.GetName()!r} is squashed flat by its transform")
        paint = paint_of(self.model, thing, raw)
        vertices = raw.vertices @ frame[:3, :3] + frame[3, :3]
        triangles = as_read = raw.triangles
        if turns < 0.0:
            triangles, paint = triangles[:, ::-1], paint._replace(colours=paint.colours[:, ::-1])
        if thing.BeamLattice().GetBeamCount():
            shape.notes.append(f"left out the beam lattice of {thing.GetName()!r}: beams are not read yet")
        if paint.lost:
            shape.notes.append("textures and mixed materials are not kept")
        known = self.slicer.get(thing.GetModelResourceID(), SlicerObject("", ()))
        shape.names.append(thing.GetName() or known.name)
        whole = (Volume(*role, 0, len(triangles) - 1),) if role else ()
        first = sum(map(len, shape.triangles))
        printed = self._add(vertices, triangles, paint, known.volumes or whole, shape)
        painted = self.paint.get((thing.PackagePart().GetPath(), thing.GetModelResourceID()))
        if painted is not None:
            regions, words = painted_regions(painted, vertices, as_read, printed, first)
            shape.regions += regions
            shape.notes += [words] if words else []

    def _add(
        self,
        vertices: Floats,
        triangles: NDArray[np.int64],
        paint: Paint,
        volumes: tuple[Volume, ...],
        shape: Shape,
    ) -> NDArray[np.bool_]:
        """Add a mesh, its blockers and enforcers apart from what is printed; tell which triangles are."""
        printed = np.ones(len(triangles), np.bool_)
        for volume in volumes:
            if volume.kind != SOLID:
                self._set_apart(volume, vertices, triangles, printed, shape)
        if not printed.all():
            triangles, paint = triangles[printed], paint._replace(colours=paint.colours[printed])
        shape.vertices.append(vertices)
        shape.triangles.append(triangles)
        shape.paints.append(paint)
        return printed

    def _set_apart(
        self,
        volume: Volume,
        vertices: Floats,
        triangles: NDArray[np.int64],
        printed: NDArray[np.bool_],
        shape: Shape,
    ) -> None:
        """Take a volume's triangles out of what is printed, and keep it as a region if it is one."""
        if not 0 <= volume.first <= volume.last < len(triangles):
            raise InputError(f"{self.where}: PrusaSlicer's volume {volume.name!r} names triangles not there")
        if volume.kind == NEGATIVE:
            raise InputError(
                f"{self.where}: {volume.name!r} is a negative volume, which amprep cannot subtract"
            )
        own = triangles[volume.first : volume.last + 1]
        printed[volume.first : volume.last + 1] = False
        used, corners = np.unique(own, return_inverse=True)
        mesh = Mesh(vertices[used], corners.reshape(-1, 3).astype(np.int32))
        shape.regions.append(Region(_REGIONS[volume.kind], volume.name, mesh=mesh))
        if volume.kind == MODIFIER:
            shape.notes.append(modifier_note(volume.name))


def modifier_note(name: str) -> str:
    """Return what is said of a modifier that was read."""
    return f"left out the modifier {name!r}; 'amprep lattice' fills it with cells"


def row_matrix(transform: "Lib3MF.Transform") -> Floats:
    """Return a 3MF transform as a ``(4, 4)`` matrix for row vectors."""
    matrix = np.eye(4)
    matrix[:, :3] = np.array([list(row) for row in transform.Fields], np.float64)
    return matrix


def _why_skipped(thing: "Lib3MF.Object") -> str:
    from lib3mf import Lib3MF

    kind = thing.GetType()
    if kind in (Lib3MF.ObjectType.Support, Lib3MF.ObjectType.SolidSupport):
        return "it is a support, and amprep plans its own"
    if kind in (Lib3MF.ObjectType.Surface, Lib3MF.ObjectType.Other):
        return "its type says that it is not to be printed"
    return ""
