"""What slicers say about triangles and components: solid volumes, support blockers, modifiers."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError
from amprep.model.mesh import Mesh
from amprep.model.part import Part, Region
from amprep.threemf.write.generic_and_cura import CURA_NAMESPACE

if TYPE_CHECKING:
    from lxml.etree import _Element
SOLID, BLOCKER, ENFORCER, NEGATIVE, MODIFIER = "solid", "blocker", "enforcer", "negative", "modifier"
_KINDS = {
    "ModelPart": SOLID,
    "NegativeVolume": NEGATIVE,
    "ParameterModifier": MODIFIER,
    "SupportBlocker": BLOCKER,
    "SupportEnforcer": ENFORCER,
}
_ROLES = {
    "negative_part": NEGATIVE,
    "modifier_part": MODIFIER,
    "support_blocker": BLOCKER,
    "support_enforcer": ENFORCER,
}


class Volume(NamedTuple):
    """Triangles `first` to `last`, both included, of a mesh object, and what they are for."""

    kind: str
    name: str
    first: int
    last: int


class SlicerObject(NamedTuple):
    """An object's name in PrusaSlicer, and its volumes."""

    name: str
    volumes: tuple[Volume, ...]


class Role(NamedTuple):
    """What a component is for, and its name."""

    kind: str
    name: str


def parse_slicer_config(config: bytes, where: str) -> dict[int, SlicerObject]:
    """Return object id -> what ``Metadata/Slic3r_PE_model.config`` says of it.

    Raises
    ------
    InputError
        If the part is not what PrusaSlicer writes.
    """
    root = _root(config, where)
    try:
        return {
            int(element.get("id", "")): SlicerObject(
                _value(element, "name"), tuple(_volume(volume) for volume in element.iterchildren("volume"))
            )
            for element in root.iterchildren("object")
        }
    except ValueError as error:
        raise InputError(f"{where}: cannot understand PrusaSlicer's model config ({error})") from error


def parse_part_roles(config: bytes, where: str) -> dict[tuple[int, int], Role]:
    """Return (object id, component's object id) -> what ``Metadata/model_settings.config`` says it is for.

    Raises
    ------
    InputError
        If the part is not what Bambu Studio and OrcaSlicer write.
    """
    root = _root(config, where)
    try:
        return {
            (int(element.get("id", "")), int(part.get("id", ""))): Role(
                _ROLES.get(part.get("subtype", ""), SOLID), _value(part, "name")
            )
            for element in root.iterchildren("object")
            for part in element.iterchildren("part")
        }
    except ValueError as error:
        raise InputError(f"{where}: cannot understand the slicer's model settings ({error})") from error


def _root(config: bytes, where: str) -> "_Element":
    from lxml import etree

    try:
        parser = etree.XMLParser(resolve_entities=False, no_network=True)
        return etree.fromstring(config or b"<config/>", parser)
    except etree.XMLSyntaxError as error:
        raise InputError(f"{where}: cannot understand the slicer's settings ({error})") from error


def _volume(element: "_Element") -> Volume:
    kind = _KINDS.get(_value(element, "volume_type"), SOLID)
    if not _value(element, "volume_type") and _value(element, "modifier") == "1":  # before PrusaSlicer 2
        kind = MODIFIER
    first, last = int(element.get("firstid", "")), int(element.get("lastid", ""))
    return Volume(kind, _value(element, "name"), first, last)


def _value(element: "_Element", key: str) -> str:
    """Return the value of the element's own metadata called `key`, "" if there is none."""
    for child in element.iterchildren("metadata"):
        if child.get("key") == key:
            return str(child.get("value", ""))
    return ""


Loose = tuple[Region, Floats]
"""A region in mm, and the positions ``(k, 3)`` at which it lies."""

_SETTINGS = {"infill_mesh": MODIFIER, "cutting_mesh": MODIFIER, "anti_overhang_mesh": BLOCKER}


def cura_role(metadata: Mapping[tuple[str, str], str], name: str) -> Role | None:
    """Return what Cura's settings of an object make of it; None for a part."""
    for setting, kind in _SETTINGS.items():
        if metadata.get((CURA_NAMESPACE, setting), "").strip().lower() == "true":
            return Role(kind, name)
    return None


def with_loose(parts: Sequence[Part], loose: Sequence[Loose]) -> list[Part]:
    """Return the parts, each with the regions whose boxes meet the box around one of its places."""
    return [
        replace(part, regions=(*part.regions, *(each for one in loose for each in _on(part, *one))))
        for part in parts
    ]


def _on(part: Part, region: Region, places: Floats) -> list[Region]:
    if region.mesh is None or part.positions is None:
        return []
    (low, high), (part_low, part_high) = region.mesh.bounds, part.mesh.bounds
    shifts = [place - at for at in part.positions for place in places]
    met = [each for each in shifts if (low + each < part_high).all() and (high + each > part_low).all()]
    different = np.unique(np.round(np.array(met).reshape(-1, 3), 6), axis=0)
    mesh = region.mesh
    return [replace(region, mesh=Mesh(mesh.vertices + each, mesh.triangles)) for each in different]
