"""The metadata of a build file, the same in every dialect."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from amprep import __version__
from amprep.model.build import Build
from amprep.model.part import Part
from amprep.threemf.build import record
from amprep.threemf.build.identifier import identifier_of
from amprep.threemf.build.metadata import joined_entries, record_digest
from amprep.threemf.build.values import JsonObject, plain, to_json, xml_text
from amprep.threemf.names import NAMESPACE
from amprep.threemf.write.document import Document, Metadata

STANDARD_NAMES = frozenset(
    [
        "Application",
        "Copyright",
        "CreationDate",
        "Description",
        "Designer",
        "LicenseTerms",
        "ModificationDate",
        "Rating",
        "Title",
    ]
)
"""Metadata names that 3MF Core allows without a namespace."""

_LONGEST_VALUE = 10_000
"""Longest metadata value in characters; lib3mf cannot read back 64 KiB of text or more."""


def distinct_parts(build: Build) -> list[Part]:
    """Return each part once, in the order of their first copies."""
    return list(dict.fromkeys(placed.part for placed in build.parts))


def title_metadata(title: str) -> Metadata:
    """Return the title and the name of this program."""
    return (("", "Title", title), ("", "Application", f"amprep {__version__}"))


def build_metadata(build: Build, parts: Sequence[Part]) -> Metadata:
    """Return the metadata of a build's model; `parts` are its distinct parts."""
    entries = {
        record.FORMAT: record.FORMAT_VERSION,
        record.IDENTIFIER: identifier_of(build),
        record.CONTENTS: to_json(record.contents_record(build)),
        record.SETTINGS: to_json(record.settings_record(build.settings)),
        record.VOLUME: to_json(record.volume_record(build.settings.space)),
        record.PARTS: to_json([record.part_record(part) for part in parts]),
        record.UNSUPPORTED: to_json([record.unsupported_record(region) for region in build.unsupported]),
    }
    if build.settings.planning:
        entries[record.PLANNING] = to_json(build.settings.planning)
    own = tuple(section for name, value in entries.items() for section in own_metadata(name, value))
    return title_metadata(build.settings.build_id) + own


def placed_part_record(build: Build, index: int, parts: Sequence[Part], digest: str) -> JsonObject:
    """Return the record of a placed part.

    Parameters
    ----------
    index
        Index of the placed part in the build.
    parts
        The distinct parts of the build.
    digest
        `Mesh.digest` of the geometry that a reader of the file gets.
    """
    placed = build.parts[index]
    entry = {
        "role": "part",
        "index": index,
        "label": placed.label,
        "part": parts.index(placed.part),
        "sha256": digest,
        "at": plain(placed.matrix[:3].reshape(-1)),
    }
    own, common = (record.orientations_record(each.orientations) for each in (placed, placed.part))
    return entry if own == common else {**entry, "orientations": own}


def support_record(build: Build, index: int, digest: str) -> JsonObject:
    """Return the record of the support with this index in the build; `digest` is that of its geometry in the file."""
    return record.support_record(index, build.supports[index], digest)


def item_metadata(records: Iterable[JsonObject]) -> Metadata:
    """Return the metadata of a build item that contains parts and supports with these records."""
    return own_metadata(record.BODIES, to_json(list(records)))


def with_digest(document: Document) -> Document:
    """Return a document of a build whose metadata state the digest of all of amprep's entries."""
    digest = record_digest(
        _own_values(document.metadata), [_own_values(each.metadata) for each in document.items]
    )
    return replace(document, metadata=(*document.metadata, *own_metadata(record.DIGEST, digest)))


def _own_values(metadata: Metadata) -> dict[str, str]:
    """Return amprep's entries as a reader of the file gets them."""
    return joined_entries({name: xml_text(value) for space, name, value in metadata if space == NAMESPACE})


def own_metadata(name: str, value: str) -> Metadata:
    """Return an entry in amprep's namespace; a long one is split into ``name``, ``name.2`` and so on."""
    cuts = range(0, max(len(value), 1), _LONGEST_VALUE)
    return tuple(
        (NAMESPACE, record.numbered(name, number), value[cut : cut + _LONGEST_VALUE])
        for number, cut in enumerate(cuts, start=1)
    )


def part_metadata(part: Part) -> Metadata:
    """Return the metadata that a part brought along and that other programs may read.

    It leaves out amprep's own entries, which are instructions of the finished job, and entries that lib3mf cannot
    write or read again; amprep's record of the part has those, too.
    """
    return tuple(
        (namespace, name, value)
        for (namespace, name), value in part.metadata.items()
        if namespace != NAMESPACE
        and (name in STANDARD_NAMES if not namespace else _is_name(name))
        and len(value) <= _LONGEST_VALUE
    )


def _is_name(name: str) -> bool:
    return name.replace("-", "_").replace(".", "_").isidentifier() and name.isprintable()
