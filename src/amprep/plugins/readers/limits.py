"""Check the counts that a mesh file declares against its length, before memory is allocated."""

import json
import re
from pathlib import Path
from typing import Any

from amprep.errors import InputError

MAX_BYTES = 2 << 30
MAX_TRIANGLES = 50_000_000

_GLB_HEADER = 20


def read_bounded(path: Path) -> bytes:
    """Return the bytes of a file.

    Raises
    ------
    InputError
        If the file cannot be read, is empty, or is larger than `MAX_BYTES`.
    """
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InputError(
                f"{path}: the file has {size >> 20} MiB, the limit is {MAX_BYTES >> 20} MiB; reduce the mesh"
            )
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot read the file: {error.strerror or error}") from error
    if not content:
        raise InputError(f"{path}: the file is empty")
    return content


def check_count(count: int, bytes_each: int, available: int, noun: str, path: Path) -> None:
    """Reject a declared count for which the file is too short, or which is above the limit.

    Parameters
    ----------
    count
        The declared count.
    bytes_each
        Least number of bytes that one element takes.
    available
        Number of bytes after the header.
    noun
        Name of the elements in messages.
    path
        The file's name in messages.

    Raises
    ------
    InputError
        If the count is too large.
    """
    if not 0 <= count <= 3 * MAX_TRIANGLES:
        raise InputError(
            f"{path}: declares {count} {noun}, the limit is {3 * MAX_TRIANGLES}; reduce the mesh"
        )
    if count * bytes_each > available:
        raise InputError(
            f"{path}: declares {count} {noun}, but the file is too short for them; it is incomplete or damaged"
        )


def check_ply(content: bytes, path: Path) -> None:
    """Check the header of a PLY file; each element takes at least one byte."""
    header, end, body = content.partition(b"end_header")
    if not content.startswith(b"ply") or not end:
        raise InputError(f"{path}: not a PLY file: it must have a header from 'ply' to 'end_header'")
    for name, count in re.findall(rb"^\s*element\s+(\S+)\s+(\S+)", header, re.MULTILINE):
        check_count(_count(count, path), 1, len(body), f"PLY elements {_shown(name)}", path)


def check_off(content: bytes, path: Path) -> None:
    """Check the counts of an OFF file; each vertex and each face takes one line."""
    lines = [line.split(b"#")[0].split() for line in content.splitlines()]
    tokens = [line for line in lines if line]
    if not tokens or not tokens[0][0].upper().endswith(b"OFF"):
        raise InputError(f"{path}: not an OFF file: it must begin with 'OFF'")
    counts = tokens[0][1:] or (tokens[1] if len(tokens) > 1 else [])
    if len(counts) < 2:
        raise InputError(f"{path}: not an OFF file: the numbers of vertices and faces must follow 'OFF'")
    expected = sum(_count(count, path) for count in counts[:2])
    lines_left = len(tokens) - (1 if tokens[0][1:] else 2)
    check_count(expected, 1, lines_left, "vertices and faces (one line each)", path)


def check_gltf(content: bytes, path: Path, *, binary: bool) -> None:
    """Check a glTF document: no external files, accessors that fit the file, and a tree of nodes."""
    document = _gltf_document(content, path, binary=binary)
    for entry in (*_records(document, "buffers"), *_records(document, "images")):
        if not str(entry.get("uri", "data:")).startswith("data:"):
            raise InputError(
                f"{path}: the file refers to another file ({str(entry['uri'])[:80]!r}); save it as one GLB"
            )
    for accessor in _records(document, "accessors"):
        check_count(_count(str(accessor.get("count", 0)).encode(), path), 1, len(content), "numbers", path)
    children = [child for node in _records(document, "nodes") for child in _list(node.get("children"))]
    if len(set(map(str, children))) < len(children):
        raise InputError(f"{path}: a node of the scene has two parents, which glTF does not allow")


def _gltf_document(content: bytes, path: Path, *, binary: bool) -> dict[str, Any]:
    if binary:
        if content[:4] != b"glTF" or len(content) < _GLB_HEADER:
            raise InputError(f"{path}: not a GLB file: it must begin with 'glTF'")
        if int.from_bytes(content[8:12], "little") > len(content):
            raise InputError(f"{path}: the file is shorter than its header declares; it is incomplete")
        content = content[_GLB_HEADER : _GLB_HEADER + int.from_bytes(content[12:16], "little")]
    try:
        document = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a glTF file ({error})") from error
    if not isinstance(document, dict):
        raise InputError(f"{path}: not a glTF file: it must be a JSON object")
    return document


def _records(document: dict[str, Any], key: str) -> list[dict[str, Any]]:
    return [entry for entry in _list(document.get(key)) if isinstance(entry, dict)]


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _count(digits: bytes, path: Path) -> int:
    if not digits.isdigit() or len(digits) > 18:
        raise InputError(f"{path}: expected a count, got {_shown(digits)}; the file is damaged")
    return int(digits)


def _shown(words: bytes) -> str:
    return repr(words[:40].decode("ascii", "replace"))
