"""Encode meshes for the 3D view: 16-bit positions, as differences in byte planes, deflated, in base64.

`viewer/decode.js` decodes them. The positions of a part of 70 mm are accurate to 1 micrometre.
"""

import zlib
from base64 import b64encode
from typing import Any

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.model import Mesh

LEVEL = 6
STEPS = 65535
"""Steps of a coordinate from the low to the high side of a mesh."""


class GeometryPack:
    """Collects meshes and gives each an index; equal meshes have the same index."""

    def __init__(self) -> None:
        self._entries: list[dict[str, Any]] = []
        self._chunks: list[bytes] = []
        self._offset = 0
        self._known: dict[str, int] = {}

    @property
    def entries(self) -> list[dict[str, Any]]:
        """Offset, counts and bounds of each mesh, which the view needs to decode it."""
        return list(self._entries)

    def add(self, mesh: Mesh) -> int:
        """Return the index of the mesh."""
        if mesh.digest not in self._known:
            self._known[mesh.digest] = len(self._entries)
            self._append(mesh)
        return self._known[mesh.digest]

    def base64(self) -> str:
        """Return all meshes, deflated, as base64."""
        return b64encode(zlib.compress(b"".join(self._chunks), LEVEL)).decode("ascii")

    def _append(self, mesh: Mesh) -> None:
        low, high = mesh.bounds if len(mesh.vertices) else (np.zeros(3), np.zeros(3))
        chunk = _positions(mesh.vertices, low, high) + _indices(mesh.triangles.ravel())
        self._entries.append(
            {
                "offset": self._offset,
                "vertices": len(mesh.vertices),
                "triangles": len(mesh.triangles),
                "low": low.tolist(),
                "high": high.tolist(),
            }
        )
        self._chunks.append(chunk)
        self._offset += len(chunk)


def _positions(vertices: Floats, low: Floats, high: Floats) -> bytes:
    """Return x, then y, then z: differences modulo 2^16, all low bytes before all high bytes."""
    extent = np.where(high > low, high - low, 1.0)
    steps = np.round((vertices - low) / extent * STEPS).astype(np.int32)
    differences = np.diff(steps, axis=0, prepend=0).astype("<u2")
    return b"".join(_planes(differences[:, axis]) for axis in range(3))


def _indices(indices: NDArray[np.int32]) -> bytes:
    """Return differences with the sign in the lowest bit, in four byte planes."""
    differences = np.diff(indices.astype(np.int64), prepend=0)
    folded = np.where(differences < 0, -2 * differences - 1, 2 * differences).astype("<u4")
    return _planes(folded)


def _planes(values: NDArray[Any]) -> bytes:
    return np.ascontiguousarray(values).view(np.uint8).reshape(-1, values.itemsize).T.tobytes()
