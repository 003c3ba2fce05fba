"""Write layers in the Common Layer Interface, version 2.0, as text or binary.

A file has a header in ASCII with the names of the bodies, then for each layer the height of its upper side and its
polylines: number of the body, direction (0 clockwise, a hole; 1 counter-clockwise, an outer contour; 2 open), number of
points, and the points, of which the last is the first one unless the polyline is open. A layer without polylines at
height 0 comes first, so that the thickness of the lowest layer is known. Binary numbers are little-endian, without
alignment.

Sources: Common Layer Interface (CLI), version 2.0, Brite-EuRam project BE2578, 1994.
"""

import struct
from collections.abc import Mapping
from typing import BinaryIO

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.slicing.layers import RESOLUTION
from amprep.geometry.slicing.text import groups_text
from amprep.slices.bodies import Layer

_LAYER, _POLYLINE = 127, 130
_HOLE, _OUTER, _OPEN = 0, 1, 2
_LONGEST_LABEL = 80

_HEAD = np.dtype([("command", "<u2"), ("values", "<i4", 3)])
_POINT = np.dtype(("<f4", 2))


class CliFile:
    """Writes one file, layer by layer.

    Parameters
    ----------
    file
        Opened for binary writing.
    names
        Name of each body in the file, by its index.
    layers
        Number of layers, without the one at height 0.
    bounds
        Least and greatest corner of the bodies, ``(2, 3)`` mm.
    is_binary
        Whether numbers are binary.
    """

    def __init__(
        self, file: BinaryIO, names: Mapping[int, str], layers: int, bounds: Floats, *, is_binary: bool
    ) -> None:
        self._file, self._names, self._is_binary = file, names, is_binary
        corners = ",".join(f"{value:.4f}" for value in (bounds + 0.0).ravel().tolist())
        lines = [
            "$$HEADERSTART",
            "$$BINARY" if is_binary else "$$ASCII",
            "$$UNITS/1" if is_binary else f"$$UNITS/{RESOLUTION:.4f}",
            "$$VERSION/200",
            *(f"$$LABEL/{number + 1},{_label(name)}" for number, name in names.items()),
            f"$$DIMENSION/{corners}",
            f"$$LAYERS/{layers + 1}",
            "$$HEADEREND",
        ]
        # binary numbers follow the header without a line break
        file.write("\n".join(lines).encode("ascii"))
        file.write(b"" if is_binary else b"\n$$GEOMETRYSTART\n")
        self._begin(0.0)

    def add(self, layer: Layer) -> None:
        """Write a layer."""
        self._begin(layer.top_mm)
        for body, contours, own in layer.contours:
            if body not in self._names:
                continue
            points, first = contours.polylines_of(own)
            if contours.is_open:
                direction = np.full(len(own), _OPEN)
            else:
                direction = np.where(contours.area[own.start : own.stop] > 0.0, _OUTER, _HOLE)
            heads = np.stack([np.full(len(own), body + 1), direction, np.diff(first)], axis=1)
            self._file.write(
                _binary(heads, points, first) if self._is_binary else _text(heads, points, first)
            )

    def end(self) -> None:
        """Write the end of the file."""
        if not self._is_binary:
            self._file.write(b"$$GEOMETRYEND\n")

    def _begin(self, top: float) -> None:
        if self._is_binary:
            self._file.write(struct.pack("<Hf", _LAYER, top))
        else:
            self._file.write(f"$$LAYER/{top / RESOLUTION:.4f}\n".encode())


def _text(heads: Int64s, points: Floats, first: Int64s) -> bytes:
    """Return polylines as text: number of the body, direction and number of points, and the points."""
    rounded = np.rint(points / RESOLUTION).astype(np.int64)
    return groups_text(heads, (b"$$POLYLINE/", b",", b",", b"", b"\n"), rounded, first, (b",", b",", b""), 0)


def _binary(heads: Int64s, points: Floats, first: Int64s) -> bytes:
    """Return polylines as binary numbers, each as its head and its points."""
    packed = np.empty(len(heads), _HEAD)
    packed["command"], packed["values"] = _POLYLINE, heads
    begins = np.arange(len(heads)) * _HEAD.itemsize + first[:-1] * _POINT.itemsize
    of_points = np.arange(len(points)) * _POINT.itemsize
    of_points += np.repeat(np.arange(1, len(heads) + 1) * _HEAD.itemsize, np.diff(first))
    data = np.empty(len(heads) * _HEAD.itemsize + len(points) * _POINT.itemsize, np.uint8)
    data[begins[:, None] + np.arange(_HEAD.itemsize)] = packed.view(np.uint8).reshape(len(heads), -1)
    data[of_points[:, None] + np.arange(_POINT.itemsize)] = (
        points.astype("<f4").view(np.uint8).reshape(len(points), -1)
    )
    return data.tobytes()


def _label(name: str) -> str:
    """Return a name without what the header cannot hold: line breaks, commas, dollar signs, and other than ASCII."""
    text = name.encode("ascii", "replace").decode()
    return "".join("_" if each in "$,/" or not each.isprintable() else each for each in text)[:_LONGEST_LABEL]
