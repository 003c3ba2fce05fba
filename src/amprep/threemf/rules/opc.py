"""Rules of the package: chapter 2.1 of the core specification, and the Open Packaging Conventions behind it."""

import posixpath
from collections.abc import Iterator, Mapping
from typing import NamedTuple
from urllib.parse import unquote

from amprep.threemf.names import ROOT_RELATIONSHIPS
from amprep.threemf.package.xml import parse_xml
from amprep.threemf.rules.broken import BrokenRules

CONTENT_TYPES = "[Content_Types].xml"
START_PART = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
MODEL_TYPE = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
THUMBNAIL = "http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"
PRINT_TICKET = "http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket"
TEXTURE = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture"

_IMAGES = ("image/jpeg", "image/png")
_TEXTURES = (*_IMAGES, "application/vnd.ms-package.3dmanufacturing-3dmodeltexture")


class Relationship(NamedTuple):
    """A relationship of a package.

    Attributes
    ----------
    source
        Name of the entry that contains it.
    target
        Name of the entry that it refers to.
    external
        Whether it refers out of the package.
    """

    source: str
    kind: str
    target: str
    external: bool
    identifier: str


def check_package(entries: Mapping[str, bytes], found: BrokenRules) -> str:
    """Add the rules that the package breaks; return the name of its start part, or "" if it has none."""
    names = {name.lower(): name for name in entries}
    relationships = [
        each for name in entries if name.lower().endswith(".rels") for each in _read(name, entries)
    ]
    _check_relationships(relationships, names, found)
    types = _content_types(entries, found)
    _check_content_types(relationships, types, names, found)
    _check_names(entries, found)
    return _start_part(relationships, names, found)


def _read(name: str, entries: Mapping[str, bytes]) -> Iterator[Relationship]:
    """Yield the relationships of an entry; `open_package` has parsed it already."""
    folder = posixpath.dirname(posixpath.dirname(name))
    for each in parse_xml(entries[name]).iterchildren("{*}Relationship"):
        target = each.get("Target", "")
        inside = posixpath.normpath(posixpath.join("/", folder, unquote(target))).lstrip("/")
        external = each.get("TargetMode") == "External" or ":" in target.split("/")[0]
        yield Relationship(name, each.get("Type", ""), inside, external, each.get("Id", ""))


def _start_part(relationships: list[Relationship], names: Mapping[str, str], found: BrokenRules) -> str:
    """Return the name of the only start part, if it is in the package."""
    starts = [each for each in relationships if each.source == ROOT_RELATIONSHIPS and each.kind == START_PART]
    inside = [each for each in starts if not each.external and each.target.lower() in names]
    if len(starts) == len(inside) == 1:
        return names[inside[0].target.lower()]
    if not starts:
        expected = "a relationship of the package must name the 3D model that is the start part"
        place = ROOT_RELATIONSHIPS
    elif len(starts) > 1:
        expected = "the package must have one start part"
        place = f"{ROOT_RELATIONSHIPS} names {len(starts)}"
    else:
        expected = "the start part must be in the package"
        place = f"{ROOT_RELATIONSHIPS} names {starts[0].target!r}"
    found.add("3MF core 2.1.1", expected, place, touches_parts=True)
    return ""


def _check_relationships(
    relationships: list[Relationship], names: Mapping[str, str], found: BrokenRules
) -> None:
    seen: set[tuple[str, str, str]] = set()
    identifiers: set[tuple[str, str]] = set()
    tickets: dict[str, int] = {}
    for each in relationships:
        place = f"{each.source}, target {each.target!r}"
        if each.external:
            expected = "no relationship may refer to anything outside the package"
            found.add("3MF core 2.1.1", expected, place, touches_parts=False)
        elif each.target.lower() not in names:
            expected = "the target of a relationship must be in the package"
            found.add("3MF core 2.1.1", expected, place, touches_parts=False)
        if (each.source, each.kind, each.target) in seen:
            expected = "no two relationships of one type may have the same source and target"
            found.add("3MF core 2.1.1", expected, place, touches_parts=False)
        if (each.source, each.identifier) in identifiers:
            expected = "the identifiers of the relationships of a part must differ"
            found.add("OPC 9.3", expected, f"{each.source}, {each.identifier!r}", touches_parts=False)
        seen.add((each.source, each.kind, each.target))
        identifiers.add((each.source, each.identifier))
        tickets[each.source] = tickets.get(each.source, 0) + (each.kind == PRINT_TICKET)
    for source, count in tickets.items():
        if count > 1:
            expected = "a model part must have at most one print ticket"
            found.add("3MF core 2.1.4", expected, source, touches_parts=False)


def _content_types(entries: Mapping[str, bytes], found: BrokenRules) -> dict[str, str]:
    """Return suffix or lower-case part name (with a slash before it) -> content type."""
    types: dict[str, str] = {}
    try:
        root = parse_xml(entries[CONTENT_TYPES])
    except (KeyError, ValueError):
        expected = "the package must list its content types"
        found.add("OPC 10.1.2", expected, CONTENT_TYPES, touches_parts=False)
        return types
    for each in root.iterchildren("{*}Default", "{*}Override"):
        key = each.get("PartName", "").lower() or each.get("Extension", "").lower()
        types.setdefault(key, each.get("ContentType", ""))
    return types


def _check_content_types(
    relationships: list[Relationship], types: Mapping[str, str], names: Mapping[str, str], found: BrokenRules
) -> None:
    """Check the content types of models, thumbnails and textures."""
    expected_of = {START_PART: (MODEL_TYPE,), THUMBNAIL: _IMAGES, TEXTURE: _TEXTURES}
    chapter_of = {START_PART: "C.1", THUMBNAIL: "2.1.3", TEXTURE: "2.1.1"}
    for each in relationships:
        if each.kind not in expected_of or each.external or each.target.lower() not in names:
            continue
        stated = types.get(f"/{each.target.lower()}", types.get(each.target.lower().rpartition(".")[2], ""))
        if stated not in expected_of[each.kind]:
            expected = f"the content type must be {' or '.join(expected_of[each.kind][:2])}"
            place = f"{each.target} has {stated or 'none'}"
            found.add(f"3MF core {chapter_of[each.kind]}", expected, place, touches_parts=False)


def _check_names(entries: Mapping[str, bytes], found: BrokenRules) -> None:
    for name in entries:
        segments = name.removesuffix("_rels/.rels").split("/")
        wrong = any(not each for each in segments[:-1]) or any(each.endswith(".") for each in segments)
        if wrong or segments[-1].startswith("."):
            expected = (
                "names of parts must be without empty segments and without dots at the ends of segments"
            )
            found.add("3MF core 2.2.3", expected, name, touches_parts=False)
