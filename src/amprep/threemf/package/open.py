"""Open a 3MF package as if it were hostile: bounded, looked through, and mended where readers disagree."""

import io
import posixpath
import zipfile
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import unquote

from amprep.errors import InputError
from amprep.threemf.package.scan import Outline, Scanner, check_instances
from amprep.threemf.read.painted_supports import Painted, find_paint

if TYPE_CHECKING:
    from lxml.etree import _Element

MOST_BYTES = 2 << 30
MOST_ENTRIES = 10_000
MOST_RATIO = 200
"""Times a package may grow when inflated, past `FREE_BYTES`; meshes as XML grow tenfold."""
FREE_BYTES = 64 << 20

_PIECE = 1 << 20
_XML = (".model", ".rels", ".config", ".xml")
_ROOT_RELATIONS = "_rels/.rels"
_SLICER_CONFIG = "Metadata/Slic3r_PE_model.config"
_PART_CONFIG = "Metadata/model_settings.config"


class Package(NamedTuple):
    """A package that has been looked through.

    Attributes
    ----------
    data
        A package with the same contents, stored without compression, every byte of it seen by us.
    config
        ``Metadata/Slic3r_PE_model.config``, where PrusaSlicer keeps what triangles mean; may be empty.
    part_config
        ``Metadata/model_settings.config``, where Bambu Studio and OrcaSlicer keep what components mean.
    unprintable
        Indices of build items marked as not to be printed.
    notes
        What was mended.
    paint
        Model part and object id -> supports painted on the object.
    """

    data: bytes
    config: bytes
    part_config: bytes
    unprintable: frozenset[int]
    notes: tuple[str, ...]
    paint: dict[tuple[str, int], Painted]


def open_package(path: Path) -> Package:
    """Read a 3MF package, refuse it if it is hostile or broken, mend it if only careless.

    Mended are relationships to parts that are not there (PrusaSlicer's command line writes one to a
    thumbnail it does not make) or that lie outside the package: they are left out.

    Raises
    ------
    InputError
        If it cannot be read, is not a zip file, holds too much, or holds what no 3MF needs.
    """
    entries, outlines = _inflate(path)
    notes: list[str] = []
    for name in [name for name in entries if name.lower().endswith(".rels")]:
        entries[name], dropped = _without_dangling(name, entries)
        notes += [f"left out a relationship to {target!r}, which is not in the package" for target in dropped]
    if not outlines:
        raise InputError(f"{path}: no 3D model in this package; expected a 3MF file")
    check_instances(outlines, str(path))
    root = outlines.get(_root_model(entries), Outline())
    config, part_config = entries.get(_SLICER_CONFIG, b""), entries.get(_PART_CONFIG, b"")
    paint = {
        (f"/{name}", number): painted
        for name in outlines
        for number, painted in find_paint(entries[name]).items()
    }
    return Package(_stored(entries), config, part_config, frozenset(root.unprintable), tuple(notes), paint)


def _inflate(path: Path) -> tuple[dict[str, bytes], dict[str, Outline]]:
    """Inflate every entry, counting; scan the XML ones and outline the models."""
    entries: dict[str, bytes] = {}
    outlines: dict[str, Outline] = {}
    try:
        with zipfile.ZipFile(path) as archive:
            budget = min(MOST_BYTES, max(FREE_BYTES, MOST_RATIO * path.stat().st_size))
            for info in _checked(archive.infolist(), path):
                entries[info.filename] = _read(archive, info, budget, path)
                budget -= len(entries[info.filename])
                if info.filename.lower().endswith(_XML):
                    outline = _scan(entries[info.filename], f"{path}: {info.filename}")
                    if info.filename.lower().endswith(".model"):
                        outlines[info.filename] = outline
    except OSError as error:
        raise InputError(f"{path}: cannot read the file: {error.strerror or error}") from error
    except (zipfile.BadZipFile, zlib.error, EOFError) as error:
        raise InputError(f"{path}: not a 3MF package or a damaged one ({error}); export it again") from error
    except (NotImplementedError, RuntimeError, ValueError) as error:
        raise InputError(f"{path}: a 3MF package may not use this kind of zip file ({error})") from error
    return entries, outlines


def _checked(infos: list[zipfile.ZipInfo], path: Path) -> list[zipfile.ZipInfo]:
    """Return the entries that are files, once their number and names are in order."""
    if len(infos) > MOST_ENTRIES:
        raise InputError(f"{path}: {len(infos)} entries in the package, at most {MOST_ENTRIES} are read")
    files = [info for info in infos if not info.is_dir()]
    names = [info.orig_filename for info in files]
    for name in names:
        if name.startswith("/") or ".." in name.split("/") or any(char in name for char in "\\:\0"):
            raise InputError(f"{path}: an entry is named {name[:80]!r}, which leads out of the package")
    if len({name.lower() for name in names}) < len(names):
        raise InputError(f"{path}: two entries of the package have the same name")
    return files


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo, budget: int, path: Path) -> bytes:
    """Inflate one entry, whatever length its header states, up to `budget` bytes."""
    content = io.BytesIO()
    with archive.open(info) as stream:
        while piece := stream.read(_PIECE):
            content.write(piece)
            if content.tell() > budget:
                limit = f"{MOST_BYTES >> 20} MiB or {MOST_RATIO} times its size"
                raise InputError(f"{path}: inflates to more than {limit}, as no 3MF needs to; refused")
    return content.getvalue()


def _scan(content: bytes, where: str) -> Outline:
    scanner = Scanner(where)
    for start in range(0, len(content), _PIECE):
        scanner.feed(content[start : start + _PIECE])
    return scanner.close()


def _relations(content: bytes, where: str) -> "_Element":
    from lxml import etree

    try:
        return etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        raise InputError(f"{where}: not the XML expected here ({error}); the file is damaged") from error


def _root_model(entries: dict[str, bytes]) -> str:
    """Return the name of the model part that the package starts from, "" if none is named."""
    root = _relations(entries.get(_ROOT_RELATIONS, b"<none/>"), _ROOT_RELATIONS)
    for relation in root.iterchildren("{*}Relationship"):
        if str(relation.get("Type", "")).endswith("/3dmodel"):
            return _resolved(_ROOT_RELATIONS, relation.get("Target", ""))
    return ""


def _without_dangling(name: str, entries: dict[str, bytes]) -> tuple[bytes, list[str]]:
    """Leave out relationships whose target is not in the package; return the part, and the targets."""
    from lxml import etree

    present = {entry.lower() for entry in entries}
    relations = _relations(entries[name], name)
    dangling = [
        relation
        for relation in relations.iterchildren("{*}Relationship")
        if relation.get("TargetMode") == "External"
        or _resolved(name, relation.get("Target", "")).lower() not in present
    ]
    for relation in dangling:
        relations.remove(relation)
    content = etree.tostring(relations, xml_declaration=True, encoding="UTF-8") if dangling else entries[name]
    return content, [relation.get("Target", "") for relation in dangling]


def _resolved(relations: str, target: str) -> str:
    """Return the package entry that a relationship's target means."""
    folder = posixpath.dirname(posixpath.dirname(relations))
    return posixpath.normpath(posixpath.join("/", folder, unquote(target))).lstrip("/")


def _stored(entries: dict[str, bytes]) -> bytes:
    """Pack the entries again, uncompressed and undated: lib3mf shall see what we saw, and nothing else."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for name, content in entries.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return packed.getvalue()
