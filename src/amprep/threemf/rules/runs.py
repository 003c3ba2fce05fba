"""Runs of plain vertices and triangles: taken out of the text of a model part by one pattern, and read as arrays."""

import re
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s

RUN = "amprep-run"
"""Attribute of the empty element that stands for a run in the text."""

_CHUNK = 1 << 20
_MOST = 1000
"""Elements of one run; the pattern needs memory for each."""
_NUMBER = rb"[-+]?(?:\d+(?:\.\d+)?|\.\d+)(?:[eE][-+]?\d{1,2})?"
_VERTEX = b"<vertex " + b" ".join(axis + b'="' + _NUMBER + b'"' for axis in (b"x", b"y", b"z")) + rb"\s*/>\s*"
_TRIANGLE = (
    b"<triangle " + b" ".join(corner + rb'="\d{1,9}"' for corner in (b"v1", b"v2", b"v3")) + rb"\s*/>\s*"
)
_RUNS = re.compile(rb"(?:(?:%b){4,%d})|(?:(?:%b){4,%d})" % (_VERTEX, _MOST, _TRIANGLE, _MOST))


class Run(NamedTuple):
    """Vertices or triangles that follow one another.

    Attributes
    ----------
    key
        ``vertex`` or ``triangle``.
    text
        The elements.
    """

    key: str
    text: bytes

    @property
    def length(self) -> int:
        """Number of elements."""
        return self.text.count(b"<")

    @property
    def vertices(self) -> Floats:
        """``(n, 3)`` coordinates in the unit of the file."""
        return np.array(self.text.split(b'"')[1::2]).astype(np.float64).reshape(-1, 3)

    @property
    def triangles(self) -> Int64s:
        """``(n, 3)`` indices of vertices."""
        return np.array(self.text.split(b'"')[1::2]).astype(np.int64).reshape(-1, 3)


def take_runs(text: bytes) -> tuple[bytes, dict[str, Run]]:
    """Replace the runs in a text by empty elements; return the text and the runs by their numbers.

    An element in a comment is never opened, so a run in a comment is never used.
    """
    runs: dict[str, Run] = {}

    def replaced(match: re.Match[bytes]) -> bytes:
        key = "vertex" if match[0].startswith(b"<vertex") else "triangle"
        number = str(len(runs))
        runs[number] = Run(key, match[0])
        return f'<{key} {RUN}="{number}"/>'.encode()

    return _RUNS.sub(replaced, text), runs


def without_runs(content: bytes) -> Iterator[tuple[bytes, dict[str, Run]]]:
    """Yield the text of a model part piece by piece, cut before elements, with the runs that were taken out."""
    held = b""
    for start in range(0, len(content), _CHUNK):
        buffer = held + content[start : start + _CHUNK]
        cut = buffer.rfind(b"<")
        held = buffer[cut:] if cut > 0 else b""
        yield take_runs(buffer[:cut] if cut > 0 else buffer)
    yield take_runs(held)
