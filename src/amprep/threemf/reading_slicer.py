"""What PrusaSlicer says about the triangles of an object: solid volumes, support blockers, modifiers."""

from typing import NamedTuple

from amprep.errors import InputError

SOLID, BLOCKER, ENFORCER, NEGATIVE, MODIFIER = "solid", "blocker", "enforcer", "negative", "modifier"

_KINDS = {
    "ModelPart": SOLID,
    "NegativeVolume": NEGATIVE,
    "ParameterModifier": MODIFIER,
    "SupportBlocker": BLOCKER,
    "SupportEnforcer": ENFORCER,
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


def parse_slicer_config(config: bytes, where: str) -> dict[int, SlicerObject]:
    """Return object id -> what ``Metadata/Slic3r_PE_model.config`` says of it.

    Raises
    ------
    InputError
        If the part is not what PrusaSlicer writes.
    """
    from lxml import etree

    if not config:
        return {}
    try:
        root = etree.fromstring(config, etree.XMLParser(resolve_entities=False, no_network=True))
        return {
            int(element.get("id")): SlicerObject(
                _value(element, "name"), tuple(_volume(volume) for volume in element.iterchildren("volume"))
            )
            for element in root.iterchildren("object")
        }
    except (etree.XMLSyntaxError, TypeError, ValueError) as error:
        raise InputError(f"{where}: cannot understand PrusaSlicer's model config ({error})") from error


def _volume(element: object) -> Volume:
    kind = _KINDS.get(_value(element, "volume_type"), SOLID)
    if not _value(element, "volume_type") and _value(element, "modifier") == "1":  # before PrusaSlicer 2
        kind = MODIFIER
    first, last = int(element.get("firstid")), int(element.get("lastid"))  # type: ignore[attr-defined]
    return Volume(kind, _value(element, "name"), first, last)


def _value(element: object, key: str) -> str:
    """Return the value of the element's own metadata called `key`, "" if there is none."""
    for child in element.iterchildren("metadata"):  # type: ignore[attr-defined]
        if child.get("key") == key:
            return child.get("value") or ""
    return ""
