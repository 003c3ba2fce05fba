"""The parts and supports in the objects of a build job, whether components or sections of a merged mesh."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.model.build import Lattice
from amprep.model.mesh import Mesh
from amprep.threemf.build import record
from amprep.threemf.build.values import Record, listing, mapping, table, whole, word
from amprep.threemf.read.arrays import fetch_beams, fetch_mesh
from amprep.threemf.write.prusaslicer import inverse, moved_exactly

if TYPE_CHECKING:
    from lib3mf import Lib3MF

NO_COLOUR = -1


@dataclass(frozen=True, eq=False)
class Piece:
    """A part or support as the file holds it.

    Attributes
    ----------
    record
        What amprep recorded about it.
    mesh
        In coordinates of its own, of which `matrix`, ``(4, 4)``, leads to build coordinates.
    colours
        ``(m, 3)`` int64, 0xRRGGBBAA at each corner or -1; None if no triangle has any.
    surface
        Whether the object's type says that it must not be filled.
    lattice
        Its beams, in coordinates of its own like the mesh, which is only the solids then.
    """

    record: Record
    mesh: Mesh
    colours: NDArray[np.int64] | None
    matrix: Floats
    surface: bool
    lattice: Lattice | None = None

    @property
    def role(self) -> str:
        """``part`` or ``support``."""
        return word(self.record, "role", ("part", "support"))


class PieceReader:
    """Reads the pieces of a model; objects that several items share are fetched once."""

    def __init__(self, model: "Lib3MF.Model") -> None:
        self._model = model
        self._shapes: dict[int, _Shape] = {}

    def pieces(self, recorded: Sequence[Any]) -> list[Piece]:
        """Return every part and support of every item.

        Parameters
        ----------
        recorded
            For each item, the list of its pieces.

        Raises
        ------
        ValueError
            If an item holds anything that is not recorded, or the other way round.
        """
        found: list[Piece] = []
        items = self._model.GetBuildItems()
        if items.Count() != len(recorded):
            raise ValueError(f"the pieces of {len(recorded)} items are recorded, there are {items.Count()}")
        for entries in recorded:
            items.MoveNext()
            records = [mapping(each, "a piece") for each in listing(entries, record.PIECES)]
            found += self._item(items.GetCurrent(), records)
        return found

    def _item(self, item: "Lib3MF.BuildItem", records: Sequence[Record]) -> Iterator[Piece]:
        target, matrix = item.GetObjectResource(), _matrix(item.GetObjectTransform())
        if target.IsComponentsObject():
            return self._components(target, matrix, records)
        return _sections(self._shape(target), matrix, records)

    def _components(self, group: Any, matrix: Floats, records: Sequence[Record]) -> Iterator[Piece]:
        """Yield a piece for each component, in their order."""
        if group.GetComponentCount() != len(records):
            raise ValueError(f"{len(records)} pieces are recorded for {group.GetComponentCount()} components")
        for index, entry in enumerate(records):
            component = group.GetComponent(index)
            shape = self._shape(component.GetObjectResource())
            place = matrix @ _matrix(component.GetTransform())
            yield Piece(entry, shape.mesh, shape.colours, place, shape.surface, shape.lattice)

    def _shape(self, target: Any) -> "_Shape":
        from lib3mf import Lib3MF

        if not target.IsMeshObject():
            raise ValueError("an item holds something else than meshes")
        number = target.GetUniqueResourceID()
        if number not in self._shapes:
            raw = fetch_mesh(target)
            colours = self._colours(raw.properties, look=target.GetObjectLevelProperty()[0])
            surface = target.GetType() == Lib3MF.ObjectType.Support
            mesh = Mesh(raw.vertices, raw.triangles.astype(np.int32))
            lattice = self._lattice(target.BeamLattice(), mesh)
            self._shapes[number] = _Shape(
                mesh if lattice is None else lattice.solids, colours, surface, lattice
            )
        return self._shapes[number]

    def _lattice(self, lattice: "Lib3MF.BeamLattice", mesh: Mesh) -> Lattice | None:
        """Return the beams of an object, apart from the solids beside them."""
        from lib3mf import Lib3MF

        if not lattice.GetBeamCount():
            return None
        struts, radii = fetch_beams(lattice)
        shown, stand_in = lattice.GetRepresentation()
        if not shown:
            raise ValueError("beams have no mesh that stands in for them")
        mode, clipping = lattice.GetClipping()
        clips = mode == Lib3MF.BeamLatticeClipMode.Inside
        room = np.array(self._mesh(clipping).bounds) if clips else None
        used, local = np.unique(struts, return_inverse=True)
        solids = Mesh(*drop_unused_vertices(mesh.vertices, mesh.triangles.astype(np.int64)))
        return Lattice(mesh.vertices[used], local.reshape(-1, 2), radii, solids, self._mesh(stand_in), room)

    def _mesh(self, number: int) -> Mesh:
        raw = fetch_mesh(self._model.GetMeshObjectByID(number))
        return Mesh(raw.vertices, raw.triangles.astype(np.int32))

    def _colours(self, properties: NDArray[np.int64], look: int) -> NDArray[np.int64] | None:
        """Return the colours that triangles have of their own, not from resource `look` of the object."""
        groups = np.where(properties[:, 0] == look, 0, properties[:, 0])
        if not groups.any():
            return None
        colours = np.full((len(properties), 3), NO_COLOUR, dtype=np.int64)
        for group in np.unique(groups[groups > 0]).tolist():
            palette = self._model.GetColorGroupByID(group)
            rows = groups == group
            used, places = np.unique(properties[rows, 1:], return_inverse=True)
            known = np.array([_packed(palette.GetColor(each)) for each in used.tolist()])
            colours[rows] = known[places.reshape(-1, 3)]
        return colours


@dataclass(frozen=True, eq=False)
class _Shape:
    mesh: Mesh
    colours: NDArray[np.int64] | None
    surface: bool
    lattice: Lattice | None


def _sections(shape: _Shape, matrix: Floats, records: Sequence[Record]) -> Iterator[Piece]:
    """Yield the pieces of a merged mesh, which the record counts off one after the other."""
    vertex = triangle = 0
    for entry in records:
        to_vertex, to_triangle = vertex + whole(entry, "vertices"), triangle + whole(entry, "triangles")
        corners = shape.mesh.triangles[triangle:to_triangle]
        if len(corners) and not vertex <= corners.min() <= corners.max() < to_vertex:
            raise ValueError("a recorded piece has triangles outside its vertices")
        mesh = Mesh(shape.mesh.vertices[vertex:to_vertex], corners - vertex)
        colours = None if shape.colours is None else shape.colours[triangle:to_triangle]
        if colours is not None and (colours == NO_COLOUR).all():
            colours = None
        yield _in_own_coordinates(Piece(entry, mesh, colours, matrix, surface=False))
        vertex, triangle = to_vertex, to_triangle
    if (vertex, triangle) != (len(shape.mesh.vertices), len(shape.mesh.triangles)):
        raise ValueError("the recorded pieces are not the whole mesh")


def _in_own_coordinates(piece: Piece) -> Piece:
    """Return a piece that was written in the coordinates of another part in its own again."""
    if "to_part" not in piece.record:
        return piece
    to_part = table(piece.record, "to_part", 16).reshape(4, 4)
    mesh = Mesh(moved_exactly(piece.mesh.vertices, to_part), piece.mesh.triangles)
    return replace(piece, mesh=mesh, matrix=piece.matrix @ inverse(to_part))


def _matrix(transform: "Lib3MF.Transform") -> Floats:
    """Return a placement as a ``(4, 4)`` matrix for column vectors."""
    matrix = np.eye(4)
    matrix[:3] = np.array(transform.Fields, dtype=np.float64).T
    if not np.isfinite(matrix).all():
        raise ValueError("an item stands at no finite place")
    return matrix


def _packed(colour: "Lib3MF.Color") -> int:
    return int(colour.Red) << 24 | int(colour.Green) << 16 | int(colour.Blue) << 8 | int(colour.Alpha)
