"""STL, binary and ASCII: three corners a triangle, nothing shared, no unit (taken as millimetres)."""

from pathlib import Path

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError
from amprep.plugins.readers.limits import check_count

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])


def read_stl(content: bytes, path: Path) -> tuple[Floats, tuple[str, ...]]:
    """Return the corners ``(m, 3, 3)`` of the triangles, and notes.

    Raises
    ------
    InputError
        If it is neither kind of STL, or cut off.
    """
    count = int.from_bytes(content[80:_HEADER], "little")
    exact = len(content) == _HEADER + count * _RECORD.itemsize
    if not exact and content.lstrip()[:5].lower() == b"solid" and b"facet" in content[:4096].lower():
        return _read_ascii(content, path)
    if len(content) < _HEADER:
        raise InputError(f"{path}: not an STL file: too short for one, and it does not begin with 'solid'")
    check_count(count, _RECORD.itemsize, len(content) - _HEADER, "triangles", path)
    corners = np.frombuffer(content, _RECORD, count, _HEADER)["corners"].astype(np.float64)
    left = len(content) - _HEADER - count * _RECORD.itemsize
    return corners, (f"ignored {left} bytes after the last triangle",) if left else ()


def _read_ascii(content: bytes, path: Path) -> tuple[Floats, tuple[str, ...]]:
    lines = [line.split() for line in content.lower().splitlines()]
    first = [line[0] for line in lines if line]
    solids, facets = first.count(b"endsolid"), first.count(b"endfacet")
    if solids < first.count(b"solid") or facets < first.count(b"facet"):
        raise InputError(f"{path}: the last 'solid' or 'facet' has no end; the file was cut off")
    rows = [line[1:] for line in lines if line and line[0] == b"vertex"]
    try:
        corners = np.array([[float(number) for number in row] for row in rows]).reshape(facets, 3, 3)
    except ValueError as error:
        raise InputError(f"{path}: expected three vertices of three numbers in every facet") from error
    return corners, (f"its {solids} solids are taken as one part",) if solids > 1 else ()
