"""Read the parts and supports of a build file from its components, or from sections of merged meshes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.model.build import Lattice
from amprep.model.mesh import Mesh
from amprep.threemf.build import record
from amprep.threemf.build.values import JsonObject, as_list, as_object, choice, integer, table
from amprep.threemf.read.arrays import fetch_beams, fetch_mesh
from amprep.threemf.read.colours import NO_COLOUR, rgba
from amprep.threemf.transforms import column_matrix, inverse, transform_exactly

if TYPE_CHECKING:
    from lib3mf import Lib3MF


@dataclass(frozen=True, eq=False)
class _ObjectGeometry:
    """Geometry of a mesh object, shared by all its instances; see `StoredBody` for the fields."""

    mesh: Mesh
    colours: NDArray[np.int64] | None
    surface: bool
    lattice: Lattice | None


@dataclass(frozen=True, eq=False)
class StoredBody:
    """A part or support as the file stores it.

    Attributes
    ----------
    record
        Its metadata in amprep's namespace.
    mesh
        Its mesh in its own coordinates, without the beams of `lattice`.
    colours
        ``(m, 3)`` int64, 0xRRGGBBAA at each corner or -1; None if no triangle has a colour.
    matrix
        ``(4, 4)``, its own coordinates to build coordinates.
    surface
        True if the object's type says that it must not be filled.
    lattice
        Its beams, in its own coordinates.
    """

    record: JsonObject
    mesh: Mesh
    colours: NDArray[np.int64] | None
    matrix: Floats
    surface: bool
    lattice: Lattice | None = None

    @property
    def role(self) -> str:
        """``part`` or ``support``."""
        return choice(self.record, "role", ("part", "support"))


class BodyReader:
    """Reads the parts and supports of a model; an object with several instances is fetched once."""

    def __init__(self, model: "Lib3MF.Model") -> None:
        self._model = model
        self._geometries: dict[int, _ObjectGeometry] = {}

    def read(self, recorded: Sequence[Any]) -> list[StoredBody]:
        """Return every part and support of every build item.

        Parameters
        ----------
        recorded
            amprep's metadata of each item: a list with a record of each of its parts and supports.

        Raises
        ------
        ValueError
            If the items and their metadata do not agree.
        """
        found: list[StoredBody] = []
        items = list(self.items())
        if len(items) != len(recorded):
            raise ValueError(f"the metadata is that of {len(recorded)} items, the build has {len(items)}")
        for read, entries in zip(items, recorded, strict=True):
            records = [as_object(each, "a body") for each in as_list(entries, record.BODIES)]
            found += read(records)
        return found

    def items(self) -> Iterator[Callable[[Sequence[JsonObject]], Iterator[StoredBody]]]:
        """Yield for each build item a function that reads its bodies, given their records."""
        items = self._model.GetBuildItems()
        while items.MoveNext():
            yield partial(self._item, items.GetCurrent())

    def _item(self, item: "Lib3MF.BuildItem", records: Sequence[JsonObject]) -> Iterator[StoredBody]:
        target, matrix = item.GetObjectResource(), _finite_matrix(item.GetObjectTransform())
        if target.IsComponentsObject():
            return self._components(target, matrix, records)
        return _sections(self._geometry(target), matrix, records)

    def _components(self, group: Any, matrix: Floats, records: Sequence[JsonObject]) -> Iterator[StoredBody]:
        """Yield one body for each component."""
        if group.GetComponentCount() != len(records):
            raise ValueError(
                f"the metadata lists {len(records)} bodies, the item has {group.GetComponentCount()} components"
            )
        for index, entry in enumerate(records):
            component = group.GetComponent(index)
            geometry = self._geometry(component.GetObjectResource())
            placement = matrix @ _finite_matrix(component.GetTransform())
            yield StoredBody(
                entry, geometry.mesh, geometry.colours, placement, geometry.surface, geometry.lattice
            )

    def _geometry(self, target: Any) -> _ObjectGeometry:
        from lib3mf import Lib3MF

        if not target.IsMeshObject():
            raise ValueError("an item contains an object that is not a mesh")
        number = target.GetUniqueResourceID()
        if number not in self._geometries:
            raw = fetch_mesh(target)
            colours = self._colours(raw.properties, of_object=target.GetObjectLevelProperty()[0])
            mesh = Mesh(raw.vertices, raw.triangles.astype(np.int32))
            lattice = self._lattice(target.BeamLattice(), mesh)
            self._geometries[number] = _ObjectGeometry(
                mesh=mesh if lattice is None else lattice.solids,
                colours=colours,
                surface=target.GetType() == Lib3MF.ObjectType.Support,
                lattice=lattice,
            )
        return self._geometries[number]

    def _lattice(self, lattice: "Lib3MF.BeamLattice", mesh: Mesh) -> Lattice | None:
        """Return the beams of an object and, separately, the solids beside them."""
        from lib3mf import Lib3MF

        if not lattice.GetBeamCount():
            return None
        struts, radii = fetch_beams(lattice)
        has_stand_in, stand_in = lattice.GetRepresentation()
        if not has_stand_in:
            raise ValueError("beams have no representation mesh")
        mode, clipping = lattice.GetClipping()
        clips = mode == Lib3MF.BeamLatticeClipMode.Inside
        room = np.array(self._mesh(clipping).bounds) if clips else None
        used, local = np.unique(struts, return_inverse=True)
        solids = Mesh(*drop_unused_vertices(mesh.vertices, mesh.triangles.astype(np.int64)))
        return Lattice(mesh.vertices[used], local.reshape(-1, 2), radii, solids, self._mesh(stand_in), room)

    def _mesh(self, number: int) -> Mesh:
        raw = fetch_mesh(self._model.GetMeshObjectByID(number))
        return Mesh(raw.vertices, raw.triangles.astype(np.int32))

    def _colours(self, properties: NDArray[np.int64], of_object: int) -> NDArray[np.int64] | None:
        """Return the triangles' own colours, without those from the resource `of_object` of the whole object."""
        groups = np.where(properties[:, 0] == of_object, 0, properties[:, 0])
        if not groups.any():
            return None
        colours = np.full((len(properties), 3), NO_COLOUR, dtype=np.int64)
        for group in np.unique(groups[groups > 0]).tolist():
            palette = self._model.GetColorGroupByID(group)
            rows = groups == group
            used, positions = np.unique(properties[rows, 1:], return_inverse=True)
            known = np.array([rgba(palette.GetColor(each)) for each in used.tolist()])
            colours[rows] = known[positions.reshape(-1, 3)]
        return colours


def _sections(
    geometry: _ObjectGeometry, matrix: Floats, records: Sequence[JsonObject]
) -> Iterator[StoredBody]:
    """Yield the bodies of a merged mesh: consecutive sections whose lengths the records state."""
    vertex = triangle = 0
    for entry in records:
        to_vertex, to_triangle = vertex + integer(entry, "vertices"), triangle + integer(entry, "triangles")
        corners = geometry.mesh.triangles[triangle:to_triangle]
        if len(corners) and not vertex <= corners.min() <= corners.max() < to_vertex:
            raise ValueError("a recorded body has triangles outside its vertices")
        mesh = Mesh(geometry.mesh.vertices[vertex:to_vertex], corners - vertex)
        colours = None if geometry.colours is None else geometry.colours[triangle:to_triangle]
        if colours is not None and (colours == NO_COLOUR).all():
            colours = None
        yield _in_own_coordinates(StoredBody(entry, mesh, colours, matrix, surface=False))
        vertex, triangle = to_vertex, to_triangle
    if (vertex, triangle) != (len(geometry.mesh.vertices), len(geometry.mesh.triangles)):
        raise ValueError("the recorded bodies do not cover the whole mesh")


def _in_own_coordinates(body: StoredBody) -> StoredBody:
    """Return a body in its own coordinates, if it was stored in the coordinates of another part."""
    if "to_part" not in body.record:
        return body
    to_part = table(body.record, "to_part", 16).reshape(4, 4)
    mesh = Mesh(transform_exactly(body.mesh.vertices, to_part), body.mesh.triangles)
    return replace(body, mesh=mesh, matrix=body.matrix @ inverse(to_part))


def _finite_matrix(transform: "Lib3MF.Transform") -> Floats:
    """Return a transform as a ``(4, 4)`` matrix for column vectors; raise ValueError if it is not finite."""
    matrix = column_matrix(transform)
    if not np.isfinite(matrix).all():
        raise ValueError("the transform of an item contains non-finite numbers")
    return matrix
