"""Make the structure of a 3MF file with lib3mf; one triangle takes the place of each mesh."""

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
from amprep.threemf.build.values import xml_text
from amprep.threemf.names import MODEL_NAME, NAMESPACE
from amprep.threemf.write.document import (
    BeamSet,
    BuildItem,
    Document,
    MeshObject,
    Metadata,
    ObjectType,
    PlacedObject,
)
from amprep.threemf.write.geometry import Palette

_GREY = 0x808080FF
_LONGEST_NAME = 1000
"""Characters; with escapes, lib3mf reads no more than 64 KiB."""


@dataclass(frozen=True)
class Skeleton:
    """A package without its meshes and placements.

    Attributes
    ----------
    model
        XML text; each object has, in order, a ``<mesh>`` of one triangle.
    others
        Name -> content of the other entries of the package.
    palettes
        The colours of each object's triangles, if it has any.
    object_ids
        Id of each object in the file.
    placements
        UUID of an item or component -> its matrix, unless that is the identity.
    """

    model: bytes
    others: Mapping[str, bytes]
    palettes: tuple[Palette | None, ...]
    object_ids: tuple[int, ...]
    placements: Mapping[str, Floats]


def make_skeleton(document: Document, suffixes: Sequence[str]) -> Skeleton:
    """Return the package without its meshes.

    Parameters
    ----------
    suffixes
        File name suffixes of the entries that will be added to the package.

    Raises
    ------
    AmprepError
        If lib3mf refuses the document.
    """
    import lib3mf

    try:
        return _skeleton(document, suffixes)
    except lib3mf.ELib3MFException as error:
        raise AmprepError(f"cannot write {document.name!r}: lib3mf refuses it ({error})") from error


def _skeleton(document: Document, suffixes: Sequence[str]) -> Skeleton:
    builder = _Builder(document.name)
    builder.annotate(builder.model.GetMetaDataGroup(), document.metadata)
    for each in document.objects:
        builder.add_object(each)
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
    """Return whether lib3mf reads the package in its strict mode."""
    import lib3mf

    reader = lib3mf.get_wrapper().CreateModel().QueryReader("3mf")
    reader.SetStrictModeActive(True)
    try:
        reader.ReadFromFile(str(path))
    except lib3mf.ELib3MFException:
        return False
    return True


def _name(text: str) -> str:
    """Return a name that lib3mf can read again."""
    return xml_text(text)[:_LONGEST_NAME]


class _Builder:
    """Fills a lib3mf model; every identifier follows from the document's name and the order of calls."""

    def __init__(self, name: str) -> None:
        import lib3mf

        self.lib3mf = lib3mf
        self.wrapper = lib3mf.get_wrapper()
        self.model = self.wrapper.CreateModel()
        types = lib3mf.ObjectType
        self.types: dict[ObjectType, Any] = {
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
        self.properties: dict[tuple[str | None, str | None], tuple[int, int]] = {}
        self.model.SetBuildUUID(self.next_uuid())

    def next_uuid(self) -> str:
        """Return the next identifier."""
        self.uuids += 1
        return str(uuid5(NAMESPACE_URL, f"{NAMESPACE}/{self.name}/{self.uuids}"))

    def annotate(self, group: Any, entries: Metadata) -> None:
        """Add metadata to a group of lib3mf."""
        for namespace, name, value in entries:
            group.AddMetaData(namespace, name, xml_text(value), "xs:string", True)

    def add_object(self, thing: MeshObject) -> None:
        """Add an object with one triangle in place of its mesh."""
        mesh = self.model.AddMeshObject()
        corners = [self.lib3mf.Position(row) for row in ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))]
        mesh.SetGeometry(corners, [self.lib3mf.Triangle((0, 1, 2))])
        mesh.SetType(self.types[thing.type])
        mesh.SetName(_name(thing.name))
        mesh.SetPartNumber(_name(thing.part_number))
        mesh.SetUUID(self.next_uuid())
        self.annotate(mesh.GetMetaDataGroup(), thing.metadata)
        self.add_appearance(mesh, thing.appearance)
        if thing.beams is not None:
            self.add_lattice(mesh, thing.beams)
        self.meshes.append(mesh)

    def add_lattice(self, mesh: Any, beams: BeamSet) -> None:
        """Give the object one beam, so that the file declares the extension and keeps the meshes it refers to."""
        lattice, beam = mesh.BeamLattice(), self.lib3mf.Beam()
        beam.Indices[0], beam.Indices[1] = 0, 1
        beam.Radii[0] = beam.Radii[1] = 1.0
        lattice.AddBeam(beam)
        lattice.SetRepresentation(self.meshes[beams.stand_in].GetResourceID())
        if beams.clipping is not None:
            inside = self.lib3mf.BeamLatticeClipMode.Inside
            lattice.SetClipping(inside, self.meshes[beams.clipping].GetResourceID())

    def add_appearance(self, mesh: Any, appearance: Appearance) -> None:
        """Give the object its material or colour, and collect the palette of its triangles."""
        palette = None
        if appearance.triangle_colours is not None:
            colours = np.unique(np.asarray(appearance.triangle_colours).astype(np.int64))
            palette = self.add_palette(colours[colours >= 0])
        if appearance.material is not None or appearance.colour is not None:
            mesh.SetObjectLevelProperty(*self.property_of(appearance.material, appearance.colour))
        self.palettes.append(palette)

    def add_palette(self, colours: Any) -> Palette:
        """Add a colour group and return it as a palette."""
        group = self.model.AddColorGroup()
        for value in colours.tolist():
            group.AddColor(self.colour(value))
        return Palette(group.GetModelResourceID(), colours)

    def property_of(self, material: str | None, colour: str | None) -> tuple[int, int]:
        """Return the resource and property of a material or colour; equal ones are shared."""
        if (material, colour) not in self.properties:
            value = self.colour(_GREY if colour is None else int(colour.removeprefix("#"), 16))
            group = self.model.AddColorGroup() if material is None else self.model.AddBaseMaterialGroup()
            added = group.AddColor(value) if material is None else group.AddMaterial(_name(material), value)
            self.properties[material, colour] = (group.GetResourceID(), added)
        return self.properties[material, colour]

    def colour(self, value: int) -> Any:
        """Return the colour 0xRRGGBBAA for lib3mf."""
        return self.wrapper.RGBAToColor(*value.to_bytes(4, "big"))

    def add_item(self, item: BuildItem) -> None:
        """Add a build item, with a components object if its objects form a group."""
        identity = self.wrapper.GetIdentityTransform()
        if item.group:
            target = self.model.AddComponentsObject()
            target.SetName(_name(item.group))
            target.SetUUID(self.next_uuid())
            for placed in item.objects:
                self.place(target.AddComponent(self.meshes[placed.index], identity), placed)
            added = self.model.AddBuildItem(target, identity)
            added.SetUUID(self.next_uuid())
        else:
            added = self.model.AddBuildItem(self.meshes[item.objects[0].index], identity)
            self.place(added, item.objects[0])
        self.annotate(added.GetMetaDataGroup(), item.metadata)

    def place(self, added: Any, placed: PlacedObject) -> None:
        """Give an item or component an identifier, and remember its placement."""
        uuid = self.next_uuid()
        added.SetUUID(uuid)
        if (placed.matrix != np.eye(4)).any():
            self.placements[uuid] = placed.matrix
