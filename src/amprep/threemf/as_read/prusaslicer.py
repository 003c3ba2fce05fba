"""What PrusaSlicer prints: the volumes that its own configuration cuts out of each object's triangles.

By PrusaSlicer's reader (libslic3r, Format/3mf.cpp): an object that the configuration does not name is one volume; the
version in the metadata, which is found by its literal name, decides whether volumes are moved; objects of another type
than `model` are not read; an item is printed unless its attribute begins with zero.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.checks.printed.found import PrintedBody, PrintedFile, PrintedKind
from amprep.model.mesh import Mesh
from amprep.threemf.as_read.meshes import ObjectMeshes, placed
from amprep.threemf.as_read.structure import MeshInstance, Structure
from amprep.threemf.names import PRUSASLICER_CONFIG
from amprep.threemf.package.xml import parse_xml

if TYPE_CHECKING:
    from lxml.etree import _Element

_KINDS: dict[str, PrintedKind] = {
    "ModelPart": "model",
    "NegativeVolume": "negative",
    "ParameterModifier": "modifier",
    "SupportBlocker": "blocker",
    "SupportEnforcer": "enforcer",
}
_VERSION = "slic3rpe:Version3mf"
_KNOWN_ATTRIBUTES = {"object": {"id"}, "volume": {"firstid", "lastid"}}
_KNOWN_KEYS = {"object": {"name"}, "volume": {"name", "volume_type", "modifier"}}


class _VolumeRange:
    """Triangles of an object, both ends included, with their name and kind; later settings replace earlier ones."""

    def __init__(self, first: int, last: int, settings: Sequence[tuple[str, str]]) -> None:
        self.first, self.last = first, last
        self.name = ""
        self.kind: PrintedKind = "model"
        for key, value in settings:
            if key == "name":
                self.name = value
            elif key == "volume_type":
                self.kind = _KINDS.get(value, "model")
            elif key == "modifier" and value == "1":
                self.kind = "modifier"


class _Configuration:
    """PrusaSlicer's list of objects and volumes, and the settings in it that amprep does not write."""

    def __init__(self, text: bytes) -> None:
        self.volumes: dict[int, list[_VolumeRange]] = {}
        self.foreign: list[str] = []
        root = parse_xml(text)
        if root.tag != "config":
            self.foreign.append(str(root.tag)[:40])
        for thing in root.iterchildren("object"):
            number = int(thing.get("id", ""))
            if number in self.volumes:
                raise ValueError(f"PrusaSlicer's configuration names object {number} twice")
            self._values(thing, "object")
            self.volumes[number] = [
                _VolumeRange(
                    int(each.get("firstid", "")), int(each.get("lastid", "")), self._values(each, "volume")
                )
                for each in thing.iterchildren("volume")
            ]

    def _values(self, element: "_Element", kind: str) -> list[tuple[str, str]]:
        values = []
        self.foreign += [
            f"{name} of {kind}"[:40]
            for name in map(str, element.attrib)
            if name not in _KNOWN_ATTRIBUTES[kind]
        ]
        for each in element.iterchildren("metadata"):
            key = each.get("key", "")
            if each.get("type") != kind or key not in _KNOWN_KEYS[kind]:
                self.foreign.append(key[:40])
            values.append((key, each.get("value", "")))
        self.foreign += [
            str(each.tag)[:40] for each in element.iterchildren() if each.tag not in ("metadata", "volume")
        ]
        return values


def read_as_prusaslicer(structure: Structure, meshes: ObjectMeshes) -> PrintedFile:
    """Return the volumes of every object.

    Raises
    ------
    ValueError
        If PrusaSlicer would refuse the file.
    """
    text = structure.entries.get(PRUSASLICER_CONFIG)
    config = _Configuration(b"<config/>" if text is None else text)
    bodies = [
        body
        for instance in structure.instances()
        for body in _bodies(instance, config.volumes.get(instance.object_id), meshes)
    ]
    remarks = [*structure.remarks(), *_remarks(structure, config)]
    if text is None:
        remarks.append(
            f"its configuration is missing ({PRUSASLICER_CONFIG}), so parts and supports are one volume"
        )
    return PrintedFile("PrusaSlicer", structure.unit_mm, tuple(bodies), tuple(remarks))


def _bodies(
    instance: MeshInstance, volumes: list[_VolumeRange] | None, meshes: ObjectMeshes
) -> list[PrintedBody]:
    """Return the volumes of an instance, in build coordinates."""
    vertices, triangles = meshes.of(instance.object_id)
    if volumes is None:
        volumes = [_VolumeRange(0, len(triangles) - 1, [("name", instance.name)])]
    is_read = instance.printable and all(each.type in ("", "model") for each in instance.path)
    found = []
    for volume in volumes:
        if not 0 <= volume.first <= volume.last < len(triangles):
            raise ValueError(f"PrusaSlicer refuses volume {volume.name[:80]!r}: its triangles do not exist")
        mesh = _part_of(vertices, triangles[volume.first : volume.last + 1], instance.matrix)
        found.append(PrintedBody(volume.name, volume.kind if is_read else "nothing", mesh))
    return found


def _part_of(vertices: Floats, triangles: Int64s, matrix: Floats) -> Mesh:
    """Return a mesh of some triangles, with the vertices from the first to the last that they use."""
    first, last = int(triangles.min()), int(triangles.max())
    return Mesh(placed(vertices[first : last + 1], matrix), (triangles - first).astype(np.int32))


def _remarks(structure: Structure, config: _Configuration) -> list[str]:
    found = []
    if structure.metadata(_VERSION) != "1":
        found.append(f"it would move the volumes, because the metadata {_VERSION} is not 1")
    if config.foreign:
        found.append(
            f"its configuration has settings that amprep does not write: {', '.join(config.foreign)[:80]}"
        )
    others = [
        name
        for name in structure.entries
        if name.lower().startswith("metadata/") and name != PRUSASLICER_CONFIG
    ]
    found += [
        f"the package has settings of PrusaSlicer that amprep does not write, {name[:80]}"
        for name in others[:1]
    ]
    objects = {item.object_id for item in structure.items}
    found += [
        f"its configuration names object {number}, which is not in the build"
        for number in config.volumes
        if number not in objects
    ]
    return found
