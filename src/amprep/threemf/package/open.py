"""Open a 3MF package as if it were hostile: limit its size, scan its XML and repair its relationships."""

import io
import lzma
import posixpath
import zipfile
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import unquote

from amprep.errors import InputError
from amprep.threemf.names import BAMBU_CONFIG, PRUSASLICER_CONFIG, ROOT_RELATIONSHIPS
from amprep.threemf.package.painted_supports import PaintedSupports, find_painted_supports
from amprep.threemf.package.scan import Outline, Scanner, check_instances
from amprep.threemf.package.xml import parse_xml

if TYPE_CHECKING:
    from lxml.etree import _Element

MOST_BYTES = 2 << 30
"""Largest inflated package that is read."""
MOST_ENTRIES = 10_000
MOST_RATIO = 200
"""Largest ratio of inflated to packed size, above `FREE_BYTES`; meshes as XML reach a ratio of about 10."""
FREE_BYTES = 64 << 20
"""Inflated size up to which the ratio is not limited."""

_CHUNK = 1 << 20
_XML = (".model", ".rels", ".config", ".xml")


class Contents(NamedTuple):
    """The entries of a package as they are in the file.

    Attributes
    ----------
    entries
        Name -> contents of each entry; the XML among them is well-formed and has no document type definition.
    outlines
        Name -> outline of each model part.
    """

    entries: dict[str, bytes]
    outlines: dict[str, Outline]


class Package(NamedTuple):
    """A package that has been scanned.

    Attributes
    ----------
    data
        A zip file with the same contents, stored without compression, built from the bytes that were scanned.
    prusaslicer_config
        ``Metadata/Slic3r_PE_model.config``, PrusaSlicer's list of volumes; may be empty.
    bambu_config
        ``Metadata/model_settings.config``, in which Bambu Studio and OrcaSlicer store the roles of components;
        may be empty.
    unprintable
        Indices of the build items that are marked as not printable.
    painted
        (model part, object id) -> supports painted on the object.
    """

    data: bytes
    prusaslicer_config: bytes
    bambu_config: bytes
    unprintable: frozenset[int]
    painted: dict[tuple[str, int], PaintedSupports]


def open_package(path: Path) -> Package:
    """Read a 3MF package; see `read_contents` and `package_of`."""
    return package_of(read_contents(path), path)


def package_of(contents: Contents, path: Path) -> Package:
    """Return the package of contents, without relationships whose target is missing or outside the package.

    PrusaSlicer's command line, for example, writes a relationship to a thumbnail that it does not make.

    Raises
    ------
    InputError
        If there is no model, if objects contain themselves, or for too many instances.
    """
    entries, outlines = contents
    entries |= {name: _without_dangling(name, entries) for name in entries if name.lower().endswith(".rels")}
    if not outlines:
        raise InputError(f"{path}: expected a 3MF file, found no 3D model in the package; export it again")
    check_instances(outlines, str(path))
    root = outlines.get(_root_model(entries), Outline())
    painted = {
        (f"/{name}", object_id): supports
        for name in outlines
        for object_id, supports in find_painted_supports(entries[name]).items()
    }
    return Package(
        data=_stored(entries),
        prusaslicer_config=entries.get(PRUSASLICER_CONFIG, b""),
        bambu_config=entries.get(BAMBU_CONFIG, b""),
        unprintable=frozenset(root.unprintable),
        painted=painted,
    )


def read_contents(path: Path) -> Contents:
    """Inflate every entry within the size limit and scan XML entries.

    Raises
    ------
    InputError
        If the file cannot be read, is not a zip file, exceeds a limit, or contains something that no 3MF file
        needs.
    """
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
    except (zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError) as error:
        raise InputError(
            f"{path}: not a 3MF file, or a damaged one ({error}); give a .3mf file, or export it again"
        ) from error
    except (NotImplementedError, RuntimeError, ValueError) as error:
        raise InputError(f"{path}: a 3MF package may not use this kind of zip file ({error})") from error
    return Contents(entries, outlines)


def _checked(infos: list[zipfile.ZipInfo], path: Path) -> list[zipfile.ZipInfo]:
    """Return the entries that are files, after a check of their number and names."""
    if len(infos) > MOST_ENTRIES:
        raise InputError(
            f"{path}: expected at most {MOST_ENTRIES} entries in the package, found {len(infos)}"
        )
    files = [info for info in infos if not info.is_dir()]
    names = [info.orig_filename for info in files]
    for name in names:
        if name.startswith("/") or ".." in name.split("/") or any(char in name for char in "\\:\0"):
            raise InputError(f"{path}: the entry name {name[:80]!r} points outside the package")
    if len({name.lower() for name in names}) < len(names):
        raise InputError(f"{path}: two entries of the package have the same name")
    return files


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo, budget: int, path: Path) -> bytes:
    """Inflate one entry up to `budget` bytes, regardless of the length that its header states."""
    content = io.BytesIO()
    with archive.open(info) as stream:
        while chunk := stream.read(_CHUNK):
            content.write(chunk)
            if content.tell() > budget:
                limit = f"{MOST_BYTES >> 20} MiB or {MOST_RATIO} times its size"
                raise InputError(f"{path}: inflates to more than {limit}, which no 3MF file needs; refused")
    return content.getvalue()


def _scan(content: bytes, where: str) -> Outline:
    scanner = Scanner(where)
    for start in range(0, len(content), _CHUNK):
        scanner.feed(content[start : start + _CHUNK])
    return scanner.close()


def _relationships(content: bytes, where: str) -> "_Element":
    try:
        return parse_xml(content)
    except ValueError as error:
        raise InputError(f"{where}: cannot parse the relationships ({error}); the file is damaged") from error


def _root_model(entries: dict[str, bytes]) -> str:
    """Return the name of the package's root model part, or "" if it names none."""
    root = _relationships(entries.get(ROOT_RELATIONSHIPS, b"<none/>"), ROOT_RELATIONSHIPS)
    for relationship in root.iterchildren("{*}Relationship"):
        if str(relationship.get("Type", "")).endswith("/3dmodel"):
            return _resolved(ROOT_RELATIONSHIPS, relationship.get("Target", ""))
    return ""


def _without_dangling(name: str, entries: dict[str, bytes]) -> bytes:
    """Return a part of relationships with different ids, without those to targets that are not in the package."""
    from lxml import etree

    present = {entry.lower() for entry in entries}
    relationships = _relationships(entries[name], name)
    dangling = [
        each
        for each in relationships.iterchildren("{*}Relationship")
        if each.get("TargetMode") == "External"
        or _resolved(name, each.get("Target", "")).lower() not in present
    ]
    ids = [each.get("Id") for each in relationships.iterchildren("{*}Relationship")]
    if not dangling and len(set(ids)) == len(ids):
        return entries[name]
    for each in dangling:
        relationships.remove(each)
    for number, each in enumerate(relationships.iterchildren("{*}Relationship")):
        each.set("Id", f"rel{number}")
    content: bytes = etree.tostring(relationships, xml_declaration=True, encoding="UTF-8")
    return content


def _resolved(relationships: str, target: str) -> str:
    """Return the name of the entry that a target in the part `relationships` refers to."""
    folder = posixpath.dirname(posixpath.dirname(relationships))
    return posixpath.normpath(posixpath.join("/", folder, unquote(target))).lstrip("/")


def _stored(entries: dict[str, bytes]) -> bytes:
    """Pack the scanned entries again, uncompressed and undated, so that lib3mf reads exactly these bytes."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for name, content in entries.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return packed.getvalue()
