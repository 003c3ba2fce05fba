"""What the file records of parts and supports, in every dialect."""

from collections.abc import Iterable, Sequence

from amprep import __version__
from amprep.model.build import Build
from amprep.model.part import Part
from amprep.threemf.build import record
from amprep.threemf.build.values import Record, to_json
from amprep.threemf.write.document import Metadata

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

_LONGEST = 10_000
"""Characters of a metadata value: lib3mf cannot read back 64 KiB of text or more."""


def distinct_parts(build: Build) -> list[Part]:
    """Return each part once, in the order of their first copies."""
    return list(dict.fromkeys(placed.part for placed in build.parts))


def build_metadata(build: Build, parts: Sequence[Part]) -> Metadata:
    """Return the metadata of the whole file."""
    entries = {
        record.FORMAT: record.FORMAT_VERSION,
        record.SETTINGS: to_json(record.settings_record(build.settings)),
        record.VOLUME: to_json(record.volume_record(build.settings.space)),
        record.PARTS: to_json([record.part_record(part) for part in parts]),
        record.UNSUPPORTED: to_json([record.unsupported_record(region) for region in build.unsupported]),
    }
    titles = (("", "Title", build.settings.build_id), ("", "Application", f"amprep {__version__}"))
    return titles + tuple(part for name, value in entries.items() for part in recorded(name, value))


def part_piece(build: Build, index: int, parts: Sequence[Part], digest: str) -> Record:
    """Return the record of a placed part; `digest` is that of its geometry as the file will give it back."""
    placed = build.parts[index]
    piece = {
        "role": "part",
        "index": index,
        "label": placed.label,
        "part": parts.index(placed.part),
        "sha256": digest,
    }
    own, common = (record.orientations_record(each.orientations) for each in (placed, placed.part))
    return piece if own == common else {**piece, "orientations": own}


def support_piece(build: Build, index: int) -> Record:
    """Return the record of a support."""
    support = build.supports[index]
    return {"role": "support", "index": index, "name": support.name, "holds": list(support.parts)}


def pieces_metadata(pieces: Iterable[Record]) -> Metadata:
    """Return the metadata of an item that holds the pieces."""
    return recorded(record.PIECES, to_json(list(pieces)))


def recorded(name: str, value: str) -> Metadata:
    """Return an entry in amprep's namespace, cut into ``name``, ``name.2`` and so on if it is long."""
    cuts = range(0, max(len(value), 1), _LONGEST)
    return tuple(
        (record.NAMESPACE, record.numbered(name, number), value[cut : cut + _LONGEST])
        for number, cut in enumerate(cuts, start=1)
    )


def part_metadata(part: Part) -> Metadata:
    """Return what came with the part and other programs may read.

    Entries of amprep's own namespace are left out: they are instructions of the job, done by now. So is what
    lib3mf could not write or read again; amprep's record has it all the same.
    """
    return tuple(
        (namespace, name, value)
        for (namespace, name), value in part.metadata.items()
        if namespace != record.NAMESPACE
        and (name in STANDARD_NAMES if not namespace else _is_name(name))
        and len(value) <= _LONGEST
    )


def _is_name(name: str) -> bool:
    return name.replace("-", "_").replace(".", "_").isidentifier() and name.isprintable()
