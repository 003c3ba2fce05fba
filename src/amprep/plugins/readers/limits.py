"""What a mesh file claims to hold is checked against its length before anything is allocated for it."""

import json
import re
from pathlib import Path
from typing import Any

from amprep.errors import InputError

MOST_BYTES = 2 << 30
MOST_TRIANGLES = 50_000_000

_GLB_HEADER = 20


def read_bounded(path: Path) -> bytes:
    """Return the bytes of a file of a sensible size.

    Raises
    ------
    InputError
        If it cannot be read, is empty, or larger than `MOST_BYTES`.
    """
    try:
        size = path.stat().st_size
        if size > MOST_BYTES:
            raise InputError(
                f"{path}: {size >> 20} MiB, at most {MOST_BYTES >> 20} MiB are read; reduce the mesh"
            )
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot read the file: {error.strerror or error}") from error
    if not content:
        raise InputError(f"{path}: the file is empty")
    return content


def check_count(count: int, bytes_each: int, available: int, what: str, path: Path) -> None:
    """Refuse a declared number of things that the file is too short for, or that is beyond all use.

    Raises
    ------
    InputError
        Naming both numbers.
    """
    if not 0 <= count <= 3 * MOST_TRIANGLES:
        raise InputError(f"{path}: claims {count} {what}, at most {3 * MOST_TRIANGLES} are read")
    if count * bytes_each > available:
        raise InputError(
            f"{path}: claims {count} {what}, more than fit into this file; it is cut off or damaged"
        )


def check_ply(content: bytes, path: Path) -> None:
    """Check the header of a PLY file: every element of it takes at least a byte."""
    header, end, body = content.partition(b"end_header")
    if not content.startswith(b"ply") or not end:
        raise InputError(f"{path}: not a PLY file: expected a header from 'ply' to 'end_header'")
    for name, count in re.findall(rb"^\s*element\s+(\S+)\s+(\S+)", header, re.MULTILINE):
        check_count(_whole(count, path), 1, len(body), f"PLY elements {_shown(name)}", path)


def check_off(content: bytes, path: Path) -> None:
    """Check the counts of an OFF file: every vertex and every face has a line."""
    lines = [line.split(b"#")[0].split() for line in content.splitlines()]
    tokens = [line for line in lines if line]
    if not tokens or not tokens[0][0].upper().endswith(b"OFF"):
        raise InputError(f"{path}: not an OFF file: expected it to begin with 'OFF'")
    counts = tokens[0][1:] or (tokens[1] if len(tokens) > 1 else [])
    if len(counts) < 2:
        raise InputError(f"{path}: not an OFF file: expected the numbers of vertices and faces after 'OFF'")
    expected = sum(_whole(count, path) for count in counts[:2])
    there = len(tokens) - (1 if tokens[0][1:] else 2)
    check_count(expected, 1, there, "vertices and faces, a line each,", path)


def check_gltf(content: bytes, path: Path, *, binary: bool) -> None:
    """Check a glTF document: nothing outside the file, accessors within it, a plain tree of nodes."""
    document = _gltf_document(content, path, binary=binary)
    for thing in (*_records(document, "buffers"), *_records(document, "images")):
        if not str(thing.get("uri", "data:")).startswith("data:"):
            raise InputError(
                f"{path}: refers to another file ({str(thing['uri'])[:80]!r}); save it as one GLB"
            )
    for accessor in _records(document, "accessors"):
        check_count(_whole(str(accessor.get("count", 0)).encode(), path), 1, len(content), "numbers", path)
    children = [child for node in _records(document, "nodes") for child in _list(node.get("children"))]
    if len(set(map(str, children))) < len(children):
        raise InputError(f"{path}: a node of the scene has two parents, which glTF forbids")


def _gltf_document(content: bytes, path: Path, *, binary: bool) -> dict[str, Any]:
    if binary:
        if content[:4] != b"glTF" or len(content) < _GLB_HEADER:
            raise InputError(f"{path}: not a GLB file: expected it to begin with 'glTF'")
        if int.from_bytes(content[8:12], "little") > len(content):
            raise InputError(f"{path}: the file is shorter than its header says; it was cut off")
        content = content[_GLB_HEADER : _GLB_HEADER + int.from_bytes(content[12:16], "little")]
    try:
        document = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a glTF file ({error})") from error
    if not isinstance(document, dict):
        raise InputError(f"{path}: not a glTF file: expected a JSON object")
    return document


def _records(document: dict[str, Any], key: str) -> list[dict[str, Any]]:
    return [thing for thing in _list(document.get(key)) if isinstance(thing, dict)]


def _list(thing: Any) -> list[Any]:
    return thing if isinstance(thing, list) else []


def _whole(digits: bytes, path: Path) -> int:
    if not digits.isdigit() or len(digits) > 18:
        raise InputError(f"{path}: expected a number of things, got {_shown(digits)}")
    return int(digits)


def _shown(words: bytes) -> str:
    return repr(words[:40].decode("ascii", "replace"))
