"""Read amprep's own metadata of a build file from its XML.

lib3mf 2.5.0 cannot read it: a value comes back with part of its end tag if the end of lib3mf's buffer of 64 KiB
falls within that tag.
"""

import hashlib
import io
import json
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from amprep.threemf.build.record import DIGEST, numbered
from amprep.threemf.names import CORE_NAMESPACE, MODEL_NAME, NAMESPACE
from amprep.threemf.package.xml import parse_xml

if TYPE_CHECKING:
    from lxml.etree import _Element

_CORE = f"{{{CORE_NAMESPACE}}}"


class BuildMetadata(NamedTuple):
    """Names and values of amprep's metadata of the model and of each build item."""

    model: dict[str, str]
    items: list[dict[str, str]]


def read_metadata(package: bytes) -> BuildMetadata:
    """Read the metadata of a scanned package; it is empty if amprep did not write the file.

    Raises
    ------
    ValueError
        If the model is not well-formed.
    """
    with zipfile.ZipFile(io.BytesIO(package)) as archive:
        text = archive.read(MODEL_NAME) if MODEL_NAME in archive.namelist() else b"<model/>"
    model = parse_xml(without_meshes(text))
    items = model.iterfind(f"{_CORE}build/{_CORE}item")
    return BuildMetadata(
        _own_entries(model, model.iterfind(f"{_CORE}metadata")),
        [_own_entries(item, item.iterfind(f"{_CORE}metadatagroup/{_CORE}metadata")) for item in items],
    )


def without_meshes(text: bytes) -> bytes:
    """Return the model without its meshes, which are nearly all of its text."""
    kept, at = [], 0
    while (begin := text.find(b"<mesh>", at)) >= 0:
        kept.append(text[at:begin])
        end = text.find(b"</mesh>", begin)
        at = end + len(b"</mesh>") if end >= 0 else len(text)
    return b"".join([*kept, text[at:]])


def _own_entries(scope: "_Element", metadata: Iterable["_Element"]) -> dict[str, str]:
    """Return amprep's entries, with the sections of a split entry joined."""
    sections: dict[str, str] = {}
    for each in metadata:
        prefix, _, name = each.get("name", "").rpartition(":")
        if scope.nsmap.get(prefix) == NAMESPACE:
            sections[name] = each.text or ""
    return joined_entries(sections)


def joined_entries(sections: Mapping[str, str]) -> dict[str, str]:
    """Return metadata by name, with the sections of a split entry joined."""
    return {name: _joined(name, sections) for name in sections if "." not in name}


def record_digest(model: Mapping[str, str], items: Sequence[Mapping[str, str]]) -> str:
    """Return the SHA-256 of amprep's metadata of a model and of its build items, without the digest itself."""
    values = [
        sorted((name, value) for name, value in each.items() if name != DIGEST) for each in (model, *items)
    ]
    return hashlib.sha256(json.dumps(values).encode()).hexdigest()


def _joined(name: str, sections: Mapping[str, str]) -> str:
    count = 1
    while numbered(name, count + 1) in sections:
        count += 1
    return "".join(sections[numbered(name, number)] for number in range(1, count + 1))
