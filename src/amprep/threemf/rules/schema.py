"""The schemas of the core specification and of its materials extension, as tables."""

import math
import re
from collections.abc import Callable, Mapping
from typing import NamedTuple

from amprep.threemf.names import CORE_NAMESPACE

MATERIALS_NAMESPACE = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
PRODUCTION_NAMESPACE = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
SLICE_NAMESPACE = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07"

PREFIXES = {CORE_NAMESPACE: "", MATERIALS_NAMESPACE: "m:"}
"""Namespace -> prefix of its elements in `ELEMENTS`."""

READ_EXTENSIONS = frozenset(
    {
        CORE_NAMESPACE,
        MATERIALS_NAMESPACE,
        PRODUCTION_NAMESPACE,
        SLICE_NAMESPACE,
        "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02",
        "http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07",
        "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
    }
)
"""Namespaces that a file may require: what they change of a mesh is read, or named in a note."""

DIALECT = frozenset(
    {
        ("item", "printable"),
        ("triangle", "paint_supports"),
        ("triangle", "paint_color"),
        ("triangle", "paint_seam"),
        ("triangle", "paint_fuzzy_skin"),
        ("triangle", "face_property"),
    }
)
"""Attributes without a namespace that slicers add; the specification does not know them, but amprep does."""

_NUMBER = re.compile(r"\s*[-+]?(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?\s*")
_INTEGER = re.compile(r"\s*[0-9]{1,10}\s*")
_COLOUR = re.compile(r"#(?:[0-9A-Fa-f]{6}|[0-9A-Fa-f]{8})")
_LARGEST = 1 << 31


def is_number(text: str) -> bool:
    """Tell whether a text is a finite decimal number as the schema writes it."""
    return _NUMBER.fullmatch(text) is not None and math.isfinite(float(text))


def is_index(text: str) -> bool:
    """Tell whether a text is an index: an integer from 0."""
    return _INTEGER.fullmatch(text) is not None and int(text) < _LARGEST


def _is_identifier(text: str) -> bool:
    return is_index(text) and int(text) > 0


def _is_matrix(text: str) -> bool:
    words = text.split()
    return len(words) == 12 and all(map(is_number, words))


def _all(check: Callable[[str], bool]) -> Callable[[str], bool]:
    return lambda text: bool(text.split()) and all(map(check, text.split()))


def _one_of(*words: str) -> Callable[[str], bool]:
    return lambda text: text in words


VALUES: Mapping[str, tuple[Callable[[str], bool], str]] = {
    "number": (is_number, "a decimal number"),
    "index": (is_index, "an integer from 0"),
    "identifier": (_is_identifier, "an integer from 1"),
    "matrix": (_is_matrix, "twelve decimal numbers"),
    "colour": (lambda text: _COLOUR.fullmatch(text) is not None, "#RRGGBB or #RRGGBBAA"),
    "text": (lambda _: True, "text"),
    "path": (lambda text: text.startswith("/"), "a path that begins with a slash"),
    "truth": (_one_of("0", "1", "true", "false"), "true or false"),
    "unit": (
        _one_of("micron", "millimeter", "centimeter", "inch", "foot", "meter"),
        "micron, millimeter, centimeter, inch, foot or meter",
    ),
    "type": (
        _one_of("model", "solidsupport", "support", "surface", "other"),
        "model, solidsupport, support, surface or other",
    ),
    "identifiers": (_all(_is_identifier), "a list of integers from 1"),
    "indices": (_all(is_index), "a list of integers from 0"),
    "numbers": (_all(is_number), "a list of decimal numbers"),
    "image": (_one_of("image/jpeg", "image/png"), "image/jpeg or image/png"),
    "tiling": (_one_of("wrap", "mirror", "clamp", "none"), "wrap, mirror, clamp or none"),
    "filter": (_one_of("auto", "linear", "nearest"), "auto, linear or nearest"),
}
"""Kind of value -> its check, and what is expected in words."""


class Attribute(NamedTuple):
    """An attribute: the kind of its value, whether it must be present, and whether it says where or what a part is."""

    kind: str
    required: bool = False
    touches_parts: bool = False


class Element(NamedTuple):
    """An element of a schema.

    Attributes
    ----------
    rule
        Specification and chapter.
    attributes
        Name -> attribute; ``xml:lang`` stands for itself.
    children
        Names of the children in order; a trailing ``?``, ``*`` or ``+`` says how many there may be, as in regular
        expressions.
    touches_parts
        Whether unknown content, or a missing child, may change what a part is or where.
    open_children
        Whether it may contain elements of other namespaces.
    open_attributes
        Whether it may have attributes of any other namespace.
    text
        Whether it may contain text.
    """

    rule: str
    attributes: Mapping[str, Attribute]
    children: tuple[str, ...] = ()
    touches_parts: bool = True
    open_children: bool = False
    open_attributes: bool = True
    text: bool = False


def _given(kind: str, *, touches_parts: bool = False) -> Attribute:
    return Attribute(kind, required=True, touches_parts=touches_parts)


def _shape(kind: str, *, required: bool = True) -> Attribute:
    return Attribute(kind, required, touches_parts=True)


_PROPERTY = {name: Attribute("index") for name in ("p1", "p2", "p3")}
_DISPLAY = {"displaypropertiesid": Attribute("identifier")}


def _materials(chapter: str, attributes: Mapping[str, Attribute], children: tuple[str, ...] = ()) -> Element:
    return Element(f"3MF materials {chapter}", attributes, children, touches_parts=False)


ELEMENTS: Mapping[str, Element] = {
    "model": Element(
        "3MF core 3.4",
        {
            "unit": _shape("unit", required=False),
            "xml:lang": Attribute("text"),
            "requiredextensions": Attribute("text"),
            "recommendedextensions": Attribute("text"),
        },
        ("metadata*", "resources", "build"),
        open_children=True,
    ),
    "metadata": Element(
        "3MF core 3.4.1",
        {"name": _given("text"), "preserve": Attribute("truth"), "type": Attribute("text")},
        touches_parts=False,
        text=True,
    ),
    "metadatagroup": Element("3MF core 3.4.1", {}, ("metadata+",), touches_parts=False),
    "resources": Element("3MF core 3.4.2", {}, ("basematerials*", "object*"), open_children=True),
    "build": Element("3MF core 3.4.3", {}, ("item*",)),
    "item": Element(
        "3MF core 3.4.3.1",
        {
            "objectid": _shape("identifier"),
            "transform": _shape("matrix", required=False),
            "partnumber": Attribute("text"),
        },
        ("metadatagroup?",),
        open_children=True,
    ),
    "object": Element(
        "3MF core 4",
        {
            "id": _shape("identifier"),
            "type": _shape("type", required=False),
            "thumbnail": Attribute("path"),
            "partnumber": Attribute("text"),
            "name": Attribute("text"),
            "pid": Attribute("identifier"),
            "pindex": Attribute("index"),
        },
        ("metadatagroup?", "mesh?", "components?"),
        open_children=True,
    ),
    "mesh": Element("3MF core 4.1", {}, ("vertices", "triangles"), open_children=True, open_attributes=False),
    "vertices": Element("3MF core 4.1.3", {}, ("vertex*",), open_attributes=False),
    "vertex": Element("3MF core 4.1.3.1", {name: _shape("number") for name in "xyz"}),
    "triangles": Element("3MF core 4.1.4", {}, ("triangle*",), open_attributes=False),
    "triangle": Element(
        "3MF core 4.1.4.1",
        {
            **{name: _shape("index") for name in ("v1", "v2", "v3")},
            **_PROPERTY,
            "pid": Attribute("identifier"),
        },
    ),
    "components": Element("3MF core 4.2", {}, ("component+",), open_attributes=False),
    "component": Element(
        "3MF core 4.2.1",
        {"objectid": _shape("identifier"), "transform": _shape("matrix", required=False)},
        open_children=True,
    ),
    "basematerials": Element(
        "3MF core 5", {"id": _given("identifier"), **_DISPLAY}, ("base+",), touches_parts=False
    ),
    "base": Element(
        "3MF core 5.1", {"name": _given("text"), "displaycolor": _given("colour")}, touches_parts=False
    ),
    "m:colorgroup": _materials("2", {"id": _given("identifier"), **_DISPLAY}, ("m:color+",)),
    "m:color": _materials("2.1", {"color": _given("colour")}),
    "m:texture2dgroup": _materials(
        "3", {"id": _given("identifier"), "texid": _given("identifier"), **_DISPLAY}, ("m:tex2coord+",)
    ),
    "m:tex2coord": _materials("3.1", {"u": _given("number"), "v": _given("number")}),
    "m:compositematerials": _materials(
        "4",
        {
            "id": _given("identifier"),
            "matid": _given("identifier"),
            "matindices": _given("indices"),
            **_DISPLAY,
        },
        ("m:composite+",),
    ),
    "m:composite": _materials("4.1", {"values": _given("numbers")}),
    "m:multiproperties": _materials(
        "5",
        {"id": _given("identifier"), "pids": _given("identifiers"), "blendmethods": Attribute("text")},
        ("m:multi+",),
    ),
    "m:multi": _materials("5.1", {"pindices": _given("indices")}),
    "m:texture2d": _materials(
        "6",
        {
            "id": _given("identifier"),
            "path": _given("path"),
            "contenttype": _given("image"),
            "tilestyleu": Attribute("tiling"),
            "tilestylev": Attribute("tiling"),
            "filter": Attribute("filter"),
        },
    ),
}
"""Element -> its schema; elements of the materials extension have the prefix ``m:``."""
