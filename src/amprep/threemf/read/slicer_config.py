"""Parse the configuration that slicers add to a 3MF file: the purpose of triangles, components and objects."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from amprep.errors import InputError
from amprep.threemf.names import CURA_NAMESPACE
from amprep.threemf.package.xml import parse_xml
from amprep.threemf.slicer_volumes import PRUSASLICER_KINDS, SlicerVolume, VolumeKind

if TYPE_CHECKING:
    from lxml.etree import _Element

_BAMBU_KINDS: dict[str, VolumeKind] = {
    "negative_part": "negative",
    "modifier_part": "modifier",
    "support_blocker": "blocker",
    "support_enforcer": "enforcer",
}
_CURA_KINDS: dict[str, VolumeKind] = {
    "infill_mesh": "modifier",
    "cutting_mesh": "modifier",
    "anti_overhang_mesh": "blocker",
}


class SlicerObject(NamedTuple):
    """An object's name in PrusaSlicer, and its volumes."""

    name: str = ""
    volumes: tuple[SlicerVolume, ...] = ()


class ComponentRole(NamedTuple):
    """Purpose and name of a component or an object."""

    kind: VolumeKind
    name: str


def parse_prusaslicer_config(config: bytes, where: str) -> dict[int, SlicerObject]:
    """Return object id -> name and volumes, from ``Metadata/Slic3r_PE_model.config``.

    Raises
    ------
    InputError
        If PrusaSlicer would not write such a configuration.
    """
    try:
        root = parse_xml(config or b"<config/>")
        return {
            int(element.get("id", "")): SlicerObject(
                _value(element, "name"), tuple(_volume(volume) for volume in element.iterchildren("volume"))
            )
            for element in root.iterchildren("object")
        }
    except ValueError as error:
        raise InputError(
            f"{where}: cannot parse PrusaSlicer's configuration ({error}); export it again"
        ) from error


def parse_bambu_config(config: bytes, where: str) -> dict[tuple[int, int], ComponentRole]:
    """Return (object id, component's object id) -> role, from ``Metadata/model_settings.config``.

    Raises
    ------
    InputError
        If Bambu Studio and OrcaSlicer would not write such a configuration.
    """
    try:
        root = parse_xml(config or b"<config/>")
        return {
            (int(element.get("id", "")), int(part.get("id", ""))): ComponentRole(
                _BAMBU_KINDS.get(part.get("subtype", ""), "solid"), _value(part, "name")
            )
            for element in root.iterchildren("object")
            for part in element.iterchildren("part")
        }
    except ValueError as error:
        raise InputError(
            f"{where}: cannot parse the slicer's configuration ({error}); export it again"
        ) from error


def cura_role(metadata: Mapping[tuple[str, str], str], name: str) -> ComponentRole | None:
    """Return the role of an object by Cura's settings of it; None for a part."""
    for setting, kind in _CURA_KINDS.items():
        if metadata.get((CURA_NAMESPACE, setting), "").strip().lower() == "true":
            return ComponentRole(kind, name)
    return None


def _volume(element: "_Element") -> SlicerVolume:
    kind = PRUSASLICER_KINDS.get(_value(element, "volume_type"), "solid")
    if not _value(element, "volume_type") and _value(element, "modifier") == "1":  # before PrusaSlicer 2
        kind = "modifier"
    first, last = int(element.get("firstid", "")), int(element.get("lastid", ""))
    return SlicerVolume(_value(element, "name"), first, last, kind)


def _value(element: "_Element", key: str) -> str:
    """Return the value of the element's own metadata `key`, or "" if there is none."""
    for child in element.iterchildren("metadata"):
        if child.get("key") == key:
            return str(child.get("value", ""))
    return ""
