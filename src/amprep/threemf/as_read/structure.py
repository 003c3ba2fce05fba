"""The structure of a package as any reader finds it: unit, objects, components, build items and metadata."""

import io
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.threemf.as_read.vocabulary import foreign_words
from amprep.threemf.build.metadata import without_meshes
from amprep.threemf.names import BEAM_NAMESPACE, CORE_NAMESPACE, MODEL_NAME
from amprep.threemf.package.xml import parse_xml

if TYPE_CHECKING:
    from lxml.etree import _Element

_CORE = f"{{{CORE_NAMESPACE}}}"
_UNITS_MM = {
    "micron": 0.001,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}
_REFERENCES = re.compile(rb'(?:clippingmesh|representationmesh)="(\d{1,9})"')
_MOST_INSTANCES = 100_000


class FileObject(NamedTuple):
    """An object: its element, id, name and type, and the id and placement of each of its components."""

    element: "_Element"
    id: int
    name: str
    type: str
    components: tuple[tuple[int, Floats], ...]


class FileItem(NamedTuple):
    """A build item: id and placement of its object, and whether a reader prints it."""

    object_id: int
    matrix: Floats
    printable: bool


class MeshInstance(NamedTuple):
    """An object with a mesh at its place in the build.

    Attributes
    ----------
    object_id, name
        Of the object with the mesh.
    matrix
        ``(4, 4)`` object coordinates to build coordinates, in the file's unit.
    path
        The objects from that of the build item down to that with the mesh.
    printable
        False if the build item says not to print.
    """

    object_id: int
    name: str
    matrix: Floats
    path: tuple[FileObject, ...]
    printable: bool


@dataclass(frozen=True, eq=False)
class Structure:
    """What a package contains apart from meshes.

    Attributes
    ----------
    entries
        Contents of the small entries by name; those of other models are empty.
    unit_mm
        Length of the unit, mm.
    required_namespaces
        The extensions that a reader must know.
    meshes_of_beams
        Ids of the objects that clip beams, or stand in for them.
    foreign
        What the model has that amprep never writes, in words.
    """

    entries: Mapping[str, bytes]
    root: "_Element"
    unit_mm: float
    objects: Mapping[int, FileObject]
    items: tuple[FileItem, ...]
    required_namespaces: frozenset[str]
    meshes_of_beams: frozenset[int]
    foreign: tuple[str, ...]

    def instances(self) -> list[MeshInstance]:
        """Return every instance of an object with a mesh, in the order of the file.

        Raises
        ------
        ValueError
            If an item or a component refers to an object that does not exist, or for too many instances.
        """
        found = []
        for item in self.items:
            for instance in self._below(item.object_id, item.matrix, (), item.printable):
                found.append(instance)
                if len(found) > _MOST_INSTANCES:
                    raise ValueError(f"the build has more than {_MOST_INSTANCES} instances of objects")
        return found

    def metadata(self, name: str) -> str | None:
        """Return the model's metadata with this name, prefix included; None if there is none."""
        for each in self.root.iterchildren(f"{_CORE}metadata"):
            if each.get("name") == name:
                return each.text or ""
        return None

    def remarks(self) -> list[str]:
        """Return what no build file of any target has: further models and markup, objects that nothing refers to."""
        others = [name for name in self.entries if name.lower().endswith(".model") and name != MODEL_NAME]
        found = [f"the package has another model, {name}" for name in others]
        found += [f"the model has {each}, which amprep does not write" for each in self.foreign]
        found += [
            f"the file requires an extension that amprep does not write, {each[:80] or 'without a namespace'}"
            for each in sorted(self.required_namespaces - {BEAM_NAMESPACE})
        ]
        used = {item.object_id for item in self.items}
        used |= {inner for each in self.objects.values() for inner, _ in each.components}
        used |= self.meshes_of_beams
        found += [
            f"the file has an object {each.name!r} that the build does not use"
            for each in self.objects.values()
            if each.id not in used
        ]
        return found

    def _below(
        self, object_id: int, matrix: Floats, path: tuple[FileObject, ...], printable: bool
    ) -> Iterator[MeshInstance]:
        if object_id not in self.objects:
            raise ValueError(f"the build refers to object {object_id}, which does not exist")
        here = self.objects[object_id]
        path = (*path, here)
        if not here.components:
            yield MeshInstance(object_id, here.name, matrix, path, printable)
        for inner, placement in here.components:
            yield from self._below(inner, matrix @ placement, path, printable)


def read_structure(package: bytes) -> Structure:
    """Return the structure of a scanned package, in which no object contains itself.

    Raises
    ------
    ValueError
        If the model is missing, is not well-formed, has comments (in which structure may be hidden), or is not one that
        readers of the core specification accept.
    """
    with zipfile.ZipFile(io.BytesIO(package)) as archive:
        names = archive.namelist()
        if MODEL_NAME not in names:
            raise ValueError(f"{MODEL_NAME} is missing")
        entries = {name: b"" if name.lower().endswith(".model") else archive.read(name) for name in names}
        text = archive.read(MODEL_NAME)
    if b"<!" in text:
        raise ValueError("the model has comments, which amprep does not write")
    root = parse_xml(without_meshes(text))
    unit = root.get("unit", "millimeter")
    if unit not in _UNITS_MM:
        raise ValueError(f"the unit {unit[:20]!r} is unknown")
    objects = [_object_of(each) for each in root.iterfind(f"{_CORE}resources/{_CORE}object")]
    items = tuple(_item_of(each) for each in root.iterfind(f"{_CORE}build/{_CORE}item"))
    required = (root.nsmap.get(prefix, "") for prefix in root.get("requiredextensions", "").split())
    return Structure(
        entries,
        root,
        _UNITS_MM[unit],
        {each.id: each for each in objects},
        items,
        frozenset(required),
        _meshes_of_beams(text),
        foreign_words(text),
    )


def _object_of(element: "_Element") -> FileObject:
    components = tuple(
        (int(each.get("objectid", "")), _matrix_of(each.get("transform")))
        for each in element.iterfind(f"{_CORE}components/{_CORE}component")
    )
    name, kind = element.get("name", ""), element.get("type", "model")
    return FileObject(element, int(element.get("id", "")), name, kind, components)


def _item_of(element: "_Element") -> FileItem:
    printable = element.get("printable", "1").strip()
    return FileItem(
        int(element.get("objectid", "")), _matrix_of(element.get("transform")), printable in ("1", "true")
    )


def _matrix_of(text: str | None) -> Floats:
    """Return a transform as a ``(4, 4)`` matrix for column vectors."""
    matrix = np.eye(4)
    if text is not None:
        numbers = np.array([float(each) for each in text.split()])
        if numbers.shape != (12,) or not np.isfinite(numbers).all():
            raise ValueError("a transform must be twelve finite numbers")
        matrix[:3] = numbers.reshape(4, 3).T
    return matrix


def _meshes_of_beams(text: bytes) -> frozenset[int]:
    """Return the ids of the meshes that clip beams, or stand in for them."""
    if b":beamlattice " not in text:
        return frozenset()
    return frozenset(int(each) for each in _REFERENCES.findall(text))
