"""amprep's own metadata in a build job, read from its XML.

Not by lib3mf: in its version 2.5.0 a value comes back with part of its end tag when its buffer of 64 KiB
ends within that tag.
"""

import io
import zipfile
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

from amprep.threemf.build.record import NAMESPACE, numbered
from amprep.threemf.write.skeleton import MODEL_NAME

if TYPE_CHECKING:
    from lxml.etree import _Element

_CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


class Entries(NamedTuple):
    """Name and value of amprep's metadata: of the model, and of each build item in their order."""

    model: dict[str, str]
    items: list[dict[str, str]]


def read_entries(package: bytes) -> Entries:
    """Read the metadata of a package that has been looked through; empty where amprep wrote none.

    Raises
    ------
    ValueError
        If the model is not well-formed.
    """
    from lxml import etree

    with zipfile.ZipFile(io.BytesIO(package)) as archive:
        text = archive.read(MODEL_NAME) if MODEL_NAME in archive.namelist() else b"<model/>"
    parser = etree.XMLParser(resolve_entities=False, no_network=True)
    try:
        model = etree.fromstring(_without_meshes(text), parser)
    except etree.XMLSyntaxError as error:
        raise ValueError(f"it is not well-formed XML: {error}") from None
    items = model.iterfind(f"{_CORE}build/{_CORE}item")
    return Entries(
        _own(model, model.iterfind(f"{_CORE}metadata")),
        [_own(item, item.iterfind(f"{_CORE}metadatagroup/{_CORE}metadata")) for item in items],
    )


def _without_meshes(text: bytes) -> bytes:
    """Return the model without what is nearly all of it."""
    head, *rest = text.split(b"<mesh>")
    return head + b"".join(each.partition(b"</mesh>")[2] for each in rest)


def _own(scope: "_Element", metadata: Iterable["_Element"]) -> dict[str, str]:
    """Return amprep's entries, those that were cut into several joined."""
    parts: dict[str, str] = {}
    for each in metadata:
        prefix, _, name = each.get("name", "").rpartition(":")
        if scope.nsmap.get(prefix) == NAMESPACE:
            parts[name] = each.text or ""
    return {name: _joined(name, parts) for name in parts if "." not in name}


def _joined(name: str, parts: dict[str, str]) -> str:
    count = 1
    while numbered(name, count + 1) in parts:
        count += 1
    return "".join(parts[numbered(name, number)] for number in range(1, count + 1))
