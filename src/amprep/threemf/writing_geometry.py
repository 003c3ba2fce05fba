"""Meshes as 3MF text, every coordinate exactly as `Mesh.digest` counts it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from amprep.errors import AmprepError
from amprep.threemf.writing_document import Body

_ROWS = 20_000
_VERTEX = '<vertex x="%.6f" y="%.6f" z="%.6f"/>\n'
_TRIANGLE = '<triangle v1="%d" v2="%d" v3="%d"/>\n'
_COLOURED = '<triangle v1="%d" v2="%d" v3="%d" pid="{}" p1="%d" p2="%d" p3="%d"/>\n'


@dataclass(frozen=True, eq=False)
class Palette:
    """The colours of a body's triangles, 0xRRGGBBAA, ascending, and the id of their group in the file."""

    group: int
    colours: NDArray[np.int64]


def check_geometry(body: Body) -> None:
    """Raise AmprepError for a mesh that 3MF cannot hold: empty, not finite, bad or repeated indices."""
    vertices, triangles = body.mesh.vertices, body.mesh.triangles
    if not len(triangles):
        raise AmprepError(f"cannot write {body.name!r}: it has no triangles")
    if not np.isfinite(vertices).all() or np.abs(vertices).max() >= 1e9:
        raise AmprepError(f"cannot write {body.name!r}: it has coordinates beyond 1e9 mm or not finite")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise AmprepError(f"cannot write {body.name!r}: a triangle refers to a vertex that is not there")
    if (triangles == np.roll(triangles, 1, axis=1)).any():
        raise AmprepError(f"cannot write {body.name!r}: a triangle has the same vertex twice")


def mesh_text(body: Body, palette: Palette | None) -> Iterator[bytes]:
    """Yield the body's ``<mesh>`` element in chunks.

    lib3mf's own writer scales coordinates by 10^6 in float32, which changes one in sixteen of them.
    """
    yield b"<mesh><vertices>\n"
    vertices = np.round(body.mesh.vertices, 6) + 0.0  # adding zero turns -0 into 0
    yield from _rows(_VERTEX, vertices)
    yield b"</vertices><triangles>\n"
    if palette is None:
        yield from _rows(_TRIANGLE, body.mesh.triangles)
    else:
        yield from _coloured_triangles(body, palette)
    yield b"</triangles></mesh>"


def text_size(body: Body) -> int:
    """Return a number of bytes that the body's text does not exceed."""
    return 80 * len(body.mesh.vertices) + 150 * len(body.mesh.triangles) + 1000


def _coloured_triangles(body: Body, palette: Palette) -> Iterator[bytes]:
    """Yield runs of triangles with and without colours, in their order."""
    colours = np.asarray(body.appearance.triangle_colours).astype(np.int64)
    rows = np.hstack([body.mesh.triangles, np.searchsorted(palette.colours, colours)])
    bare = np.asarray((colours < 0).any(axis=1))
    for run in np.split(np.arange(len(rows)), np.flatnonzero(np.diff(bare)) + 1):
        if bare[run[0]]:
            yield from _rows(_TRIANGLE, rows[run, :3])
        else:
            yield from _rows(_COLOURED.format(palette.group), rows[run])


def _rows(
    template: str, rows: NDArray[np.float64] | NDArray[np.int64] | NDArray[np.int32]
) -> Iterator[bytes]:
    for start in range(0, len(rows), _ROWS):
        chunk = rows[start : start + _ROWS]
        yield (template * len(chunk) % tuple(chunk.ravel().tolist())).encode()
