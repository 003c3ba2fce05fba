"""Flatten the object of a build item, nested components included, into one mesh."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.errors import InputError
from amprep.model.mesh import Mesh
from amprep.model.part import Region, RegionKind
from amprep.threemf.package.painted_supports import PaintedSupports
from amprep.threemf.read.arrays import fetch_mesh
from amprep.threemf.read.colours import MeshColours, mesh_colours
from amprep.threemf.read.painted_supports import painted_regions
from amprep.threemf.read.slicer_config import ComponentRole, SlicerObject
from amprep.threemf.slicer_volumes import SlicerVolume, VolumeKind
from amprep.threemf.transforms import row_matrix

if TYPE_CHECKING:
    from lib3mf import Lib3MF

MOST_TRIANGLES = 50_000_000

_LARGEST_NUMBER = 1e30
"""Limit of a transform's numbers; NaN exceeds it, too."""

_REGION_KINDS: dict[VolumeKind, RegionKind] = {
    "blocker": "blocker",
    "enforcer": "enforcer",
    "modifier": "lattice",
}


@dataclass
class FlattenedItem:
    """The meshes found so far below a build item, in its own coordinates and the file's unit.

    Attributes
    ----------
    vertices, triangles
        ``(n, 3)`` and ``(m, 3)`` of each mesh; triangles refer to the vertices of their own mesh.
    colours
        Colours of each mesh.
    regions
        Blockers, enforcers and modifiers.
    names
        Name of each mesh object; may be empty.
    notes
        One sentence for everything that was left out.
    """

    vertices: list[Floats] = field(default_factory=list)
    triangles: list[NDArray[np.int64]] = field(default_factory=list)
    colours: list[MeshColours] = field(default_factory=list)
    regions: list[Region] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def joined(self) -> tuple[Floats, NDArray[np.int64]]:
        """Return vertices and triangles of all meshes as one mesh."""
        starts = np.cumsum([0, *(len(vertices) for vertices in self.vertices)])
        return np.concatenate(self.vertices), np.concatenate(
            [triangles + start for triangles, start in zip(self.triangles, starts, strict=False)]
        )


class Flattener:
    """Flattens the objects of one model.

    Parameters
    ----------
    prusaslicer
        Object id -> name and volumes.
    roles
        (object id, component's object id) -> role.
    painted
        (model part, object id) -> supports painted on the object.
    where
        Name of the file, for messages.
    """

    def __init__(
        self,
        model: "Lib3MF.Model",
        prusaslicer: Mapping[int, SlicerObject],
        roles: Mapping[tuple[int, int], ComponentRole],
        painted: Mapping[tuple[str, int], PaintedSupports],
        where: str,
    ) -> None:
        self.model = model
        self.prusaslicer = prusaslicer
        self.roles = roles
        self.painted = painted
        self.where = where
        self._triangles = 0

    def flatten(
        self, thing: "Lib3MF.Object", linear: Floats, role: ComponentRole | None = None
    ) -> FlattenedItem:
        """Return the meshes of an object.

        Parameters
        ----------
        thing
            A mesh object or a components object.
        linear
            ``(3, 3)`` map for row vectors that is applied to the vertices.
        role
            Purpose of the whole object; None for a part.

        Raises
        ------
        InputError
            If the geometry is invalid, too large, or has a negative volume.
        """
        item = FlattenedItem()
        frame = np.eye(4)
        frame[:3, :3] = linear
        self._add_object(thing, frame, role, item)
        return item

    def _add_object(
        self, thing: "Lib3MF.Object", frame: Floats, role: ComponentRole | None, item: FlattenedItem
    ) -> None:
        reason = _why_skipped(thing)
        if reason:
            item.notes.append(f"left out {thing.GetName() or 'an object'!r}: {reason}")
        elif thing.IsMeshObject():
            self._add_mesh(thing, frame, role, item)
        elif thing.IsComponentsObject():
            for index in range(thing.GetComponentCount()):
                component = thing.GetComponent(index)
                inner = component.GetObjectResource()
                key = thing.GetModelResourceID(), inner.GetModelResourceID()
                with np.errstate(all="ignore"):  # an overflow is reported with the mesh
                    inner_frame = row_matrix(component.GetTransform()) @ frame
                self._add_object(inner, inner_frame, self.roles.get(key, role), item)
        else:
            item.notes.append(f"left out {thing.GetName() or 'an object'!r}: it is not a mesh")

    def _add_mesh(
        self, thing: "Lib3MF.MeshObject", frame: Floats, role: ComponentRole | None, item: FlattenedItem
    ) -> None:
        self._triangles += thing.GetTriangleCount()
        if self._triangles > MOST_TRIANGLES:
            raise InputError(
                f"{self.where}: expected at most {MOST_TRIANGLES} triangles in the build; split the job"
            )
        mirrored = self._check_frame(frame, thing.GetName())
        raw = fetch_mesh(thing)
        colours = mesh_colours(self.model, thing, raw)
        vertices = raw.vertices @ frame[:3, :3] + frame[3, :3]
        triangles = raw.triangles
        if mirrored:
            triangles, colours = triangles[:, ::-1], colours._replace(corners=colours.corners[:, ::-1])
        if thing.BeamLattice().GetBeamCount():
            item.notes.append(
                f"left out the beam lattice of {thing.GetName()!r}: parts of beams are not supported"
            )
        if colours.incomplete:
            item.notes.append(
                "dropped textures and mixed materials: only colours and base materials are kept"
            )
        known = self.prusaslicer.get(thing.GetModelResourceID(), SlicerObject())
        item.names.append(thing.GetName() or known.name)
        whole = (SlicerVolume(role.name, 0, len(triangles) - 1, role.kind),) if role else ()
        first = sum(map(len, item.triangles))
        printed = self._add(vertices, triangles, colours, known.volumes or whole, item)
        painted = self.painted.get((thing.PackagePart().GetPath(), thing.GetModelResourceID()))
        if painted is not None:
            regions, note = painted_regions(painted, vertices, raw.triangles, printed, first)
            item.regions += regions
            item.notes += [note] if note else []

    def _check_frame(self, frame: Floats, name: str) -> bool:
        """Refuse a transform that is not finite or singular; return whether it mirrors."""
        if not np.abs(frame).max() < _LARGEST_NUMBER:
            raise InputError(
                f"{self.where}: the transform of {name!r} contains non-finite numbers; export the file again"
            )
        determinant = np.linalg.det(frame[:3, :3])
        if determinant == 0.0:
            raise InputError(
                f"{self.where}: the transform of {name!r} flattens it to a plane, a line or a point"
            )
        return bool(determinant < 0.0)

    def _add(
        self,
        vertices: Floats,
        triangles: NDArray[np.int64],
        colours: MeshColours,
        volumes: tuple[SlicerVolume, ...],
        item: FlattenedItem,
    ) -> NDArray[np.bool_]:
        """Add a mesh without the triangles of its regions; return whether each triangle is printed."""
        printed = np.ones(len(triangles), np.bool_)
        for volume in volumes:
            if volume.kind != "solid":
                self._add_region(volume, vertices, triangles, printed, item)
        if not printed.all():
            triangles, colours = triangles[printed], colours._replace(corners=colours.corners[printed])
        item.vertices.append(vertices)
        item.triangles.append(triangles)
        item.colours.append(colours)
        return printed

    def _add_region(
        self,
        volume: SlicerVolume,
        vertices: Floats,
        triangles: NDArray[np.int64],
        printed: NDArray[np.bool_],
        item: FlattenedItem,
    ) -> None:
        """Add a volume as a region, and clear its triangles in `printed`."""
        if not 0 <= volume.first <= volume.last < len(triangles):
            raise InputError(
                f"{self.where}: PrusaSlicer's volume {volume.name!r} refers to triangles that do not exist"
            )
        if volume.kind == "negative":
            raise InputError(
                f"{self.where}: {volume.name!r} is a negative volume, which amprep cannot subtract; "
                "subtract it in the slicer or remove it"
            )
        own = triangles[volume.first : volume.last + 1]
        printed[volume.first : volume.last + 1] = False
        used, corners = np.unique(own, return_inverse=True)
        mesh = Mesh(vertices[used], corners.reshape(-1, 3).astype(np.int32))
        item.regions.append(Region(_REGION_KINDS[volume.kind], volume.name, mesh=mesh))
        if volume.kind == "modifier":
            item.notes.append(modifier_note(volume.name))


def modifier_note(name: str) -> str:
    """Return the note about a modifier in a file."""
    return f"left out the modifier {name!r}; 'amprep lattice' fills it with cells"


def _why_skipped(thing: "Lib3MF.Object") -> str:
    """Return why an object is not printed, or "" if it is."""
    from lib3mf import Lib3MF

    kind = thing.GetType()
    if kind in (Lib3MF.ObjectType.Support, Lib3MF.ObjectType.SolidSupport):
        return "it is a support, and amprep plans its own"
    if kind in (Lib3MF.ObjectType.Surface, Lib3MF.ObjectType.Other):
        return "its type is not printable"
    return ""
