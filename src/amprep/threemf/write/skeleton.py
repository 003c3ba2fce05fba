"""The structure of a 3MF by lib3mf: everything but the meshes, which are one triangle each here."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any
from uuid import NAMESPACE_URL, uuid5
from zipfile import ZipFile

import numpy as np

from amprep.arrays import Floats
from amprep.errors import AmprepError
from amprep.model.part import Appearance
from amprep.threemf.build.record import NAMESPACE
from amprep.threemf.build.values import xml_text
from amprep.threemf.write.document import BeamSet, Body, Document, Instance, Item, Metadata, ObjectKind
from amprep.threemf.write.geometry import Palette

MODEL_NAME = "3D/3dmodel.model"
_GREY = 0x808080FF
_LONGEST_NAME = 1000


@dataclass(frozen=True)
class Skeleton:
    """A package without meshes and placements.

    Attributes
    ----------
    model
        XML text; each body, in order, has a ``<mesh>`` of one triangle.
    others
        The other files of the package, by name.
    palettes
        For each body, the colours of its triangles, if it has any.
    object_ids
        The number by which the file calls each body.
    placements
        UUID of each item and component that stands elsewhere than its coordinates say, with its matrix.
    """

    model: bytes
    others: Mapping[str, bytes]
    palettes: tuple[Palette | None, ...]
    object_ids: tuple[int, ...]
    placements: Mapping[str, Floats]


def make_skeleton(document: Document, suffixes: Sequence[str]) -> Skeleton:
    """Return the package without its meshes; `suffixes` are those of files that will be added to it.

    Raises
    ------
    AmprepError
        If lib3mf refuses anything in it.
    """
    import lib3mf

    try:
        return _skeleton(document, suffixes)
    except lib3mf.ELib3MFException as error:
        raise AmprepError(f"cannot write {document.name!r}: lib3mf refuses it ({error})") from error


def _skeleton(document: Document, suffixes: Sequence[str]) -> Skeleton:
    builder = _Builder(document.name)
    builder.annotate(builder.model.GetMetaDataGroup(), document.metadata)
    for body in document.bodies:
        builder.add_body(body)
    for item in document.items:
        builder.add_item(item)
    for suffix in suffixes:
        builder.model.AddCustomContentType(suffix, "text/xml")
    with ZipFile(BytesIO(bytes(builder.model.QueryWriter("3mf").WriteToBuffer()))) as package:
        files = {name: package.read(name) for name in package.namelist()}
    model = files.pop(MODEL_NAME)
    ids = tuple(mesh.GetModelResourceID() for mesh in builder.meshes)
    return Skeleton(model, files, tuple(builder.palettes), ids, builder.placements)


def is_readable(path: Path) -> bool:
    """Return whether lib3mf reads the package strictly."""
    import lib3mf

    reader = lib3mf.get_wrapper().CreateModel().QueryReader("3mf")
    reader.SetStrictModeActive(True)
    try:
        reader.ReadFromFile(str(path))
    except lib3mf.ELib3MFException:
        return False
    return True


def _name(text: str) -> str:
    """Return a name that lib3mf can read again: no more than 64 KiB, escapes included."""
    return xml_text(text)[:_LONGEST_NAME]


class _Builder:
    """Fills a lib3mf model; every identifier follows from the document's name and the order of the calls."""

    def __init__(self, name: str) -> None:
        import lib3mf

        self.lib3mf = lib3mf
        self.wrapper = lib3mf.get_wrapper()
        self.model = self.wrapper.CreateModel()
        types = lib3mf.ObjectType
        self.kinds: dict[ObjectKind, Any] = {
            "model": types.Model,
            "surface": types.Surface,
            "solidsupport": types.SolidSupport,
            "support": types.Support,
        }
        self.name = xml_text(name)
        self.uuids = 0
        self.meshes: list[Any] = []
        self.palettes: list[Palette | None] = []
        self.placements: dict[str, Floats] = {}
        self.paints: dict[tuple[str | None, str | None], tuple[int, int]] = {}
        self.model.SetBuildUUID(self.next_uuid())

    def next_uuid(self) -> str:
        self.uuids += 1
        return str(uuid5(NAMESPACE_URL, f"{NAMESPACE}/{self.name}/{self.uuids}"))

    def annotate(self, group: Any, entries: Metadata) -> None:
        for namespace, name, value in entries:
            group.AddMetaData(namespace, name, xml_text(value), "xs:string", True)

    def add_body(self, body: Body) -> None:
        mesh = self.model.AddMeshObject()
        corners = [self.lib3mf.Position(row) for row in ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))]
        mesh.SetGeometry(corners, [self.lib3mf.Triangle((0, 1, 2))])
        mesh.SetType(self.kinds[body.kind])
        mesh.SetName(_name(body.name))
        mesh.SetPartNumber(_name(body.part_number))
        mesh.SetUUID(self.next_uuid())
        self.annotate(mesh.GetMetaDataGroup(), body.metadata)
        self.paint(mesh, body.appearance)
        if body.beams is not None:
            self.add_lattice(mesh, body.beams)
        self.meshes.append(mesh)

    def add_lattice(self, mesh: Any, beams: BeamSet) -> None:
        """Give the object one beam, so that the file names the extension and keeps the meshes it refers to."""
        lattice, beam = mesh.BeamLattice(), self.lib3mf.Beam()
        beam.Indices[0], beam.Indices[1] = 0, 1
        beam.Radii[0] = beam.Radii[1] = 1.0
        lattice.AddBeam(beam)
        lattice.SetRepresentation(self.meshes[beams.stand_in].GetResourceID())
        if beams.clipping is not None:
            inside = self.lib3mf.BeamLatticeClipMode.Inside
            lattice.SetClipping(inside, self.meshes[beams.clipping].GetResourceID())

    def paint(self, mesh: Any, appearance: Appearance) -> None:
        """Give the object its material or colour, and a palette for its triangles."""
        palette = None
        if appearance.triangle_colours is not None:
            colours = np.unique(np.asarray(appearance.triangle_colours).astype(np.int64))
            palette = self.add_palette(colours[colours >= 0])
        if appearance.material is not None or appearance.colour is not None:
            mesh.SetObjectLevelProperty(*self.paint_of(appearance.material, appearance.colour))
        self.palettes.append(palette)

    def add_palette(self, colours: Any) -> Palette:
        group = self.model.AddColorGroup()
        for value in colours.tolist():
            group.AddColor(self.colour(value))
        return Palette(group.GetModelResourceID(), colours)

    def paint_of(self, material: str | None, colour: str | None) -> tuple[int, int]:
        """Return resource and property of a whole object's look; equal looks share theirs."""
        if (material, colour) not in self.paints:
            value = self.colour(_GREY if colour is None else int(colour.removeprefix("#"), 16))
            group = self.model.AddColorGroup() if material is None else self.model.AddBaseMaterialGroup()
            added = group.AddColor(value) if material is None else group.AddMaterial(_name(material), value)
            self.paints[material, colour] = (group.GetResourceID(), added)
        return self.paints[material, colour]

    def colour(self, value: int) -> Any:
        """Return lib3mf's colour of 0xRRGGBBAA."""
        return self.wrapper.RGBAToColor(*value.to_bytes(4, "big"))

    def add_item(self, item: Item) -> None:
        identity = self.wrapper.GetIdentityTransform()
        if item.group:
            target = self.model.AddComponentsObject()
            target.SetName(_name(item.group))
            target.SetUUID(self.next_uuid())
            for instance in item.instances:
                self.place(target.AddComponent(self.meshes[instance.body], identity), instance)
            placed = self.model.AddBuildItem(target, identity)
            placed.SetUUID(self.next_uuid())
        else:
            placed = self.model.AddBuildItem(self.meshes[item.instances[0].body], identity)
            self.place(placed, item.instances[0])
        self.annotate(placed.GetMetaDataGroup(), item.metadata)

    def place(self, placed: Any, instance: Instance) -> None:
        uuid = self.next_uuid()
        placed.SetUUID(uuid)
        if (instance.matrix != np.eye(4)).any():
            self.placements[uuid] = instance.matrix
