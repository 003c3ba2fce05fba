"""Read binary and ASCII STL. The format has no unit; coordinates are taken as millimetres."""

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
        If the file is not STL or is incomplete.
    """
    count = int.from_bytes(content[80:_HEADER], "little")
    exact = len(content) == _HEADER + count * _RECORD.itemsize
    if not exact and content.lstrip()[:5].lower() == b"solid" and b"facet" in content[:4096].lower():
        return _read_ascii(content, path)
    if len(content) < _HEADER:
        raise InputError(
            f"{path}: not an STL file: shorter than {_HEADER} bytes, and it does not begin with 'solid'"
        )
    check_count(count, _RECORD.itemsize, len(content) - _HEADER, "triangles", path)
    with np.errstate(invalid="ignore"):  # signalling NaN, which the next check refuses
        corners = np.frombuffer(content, _RECORD, count, _HEADER)["corners"].astype(np.float64)
    left = len(content) - _HEADER - count * _RECORD.itemsize
    return corners, (f"ignored {left} bytes after the last triangle",) if left else ()


def _read_ascii(content: bytes, path: Path) -> tuple[Floats, tuple[str, ...]]:
    lines = [line.split() for line in content.lower().splitlines()]
    first = [line[0] for line in lines if line]
    solids, facets = first.count(b"endsolid"), first.count(b"endfacet")
    if solids < first.count(b"solid") or facets < first.count(b"facet"):
        raise InputError(f"{path}: the file is incomplete: the last 'solid' or 'facet' has no end")
    rows = [line[1:] for line in lines if line and line[0] == b"vertex"]
    try:
        corners = np.array([[float(number) for number in row] for row in rows]).reshape(facets, 3, 3)
    except ValueError as error:
        raise InputError(
            f"{path}: each facet must have three vertices of three numbers; the file is damaged"
        ) from error
    return corners, (f"the {solids} solids of the file were joined to one part",) if solids > 1 else ()
