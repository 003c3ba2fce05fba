"""Meshes as 3MF text, every coordinate exactly as `Mesh.digest` counts it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.errors import AmprepError
from amprep.threemf.write.document import BeamSet, Body

_ROWS = 20_000
_VERTEX = '<vertex x="%.6f" y="%.6f" z="%.6f"/>\n'
_TRIANGLE = '<triangle v1="%d" v2="%d" v3="%d"/>\n'
_BEAM = '<b:beam v1="%d" v2="%d"/>\n'
_SIZED = '<b:beam v1="%d" v2="%d" r1="{:.9g}" r2="{:.9g}"/>\n'
_COLOURED = '<triangle v1="%d" v2="%d" v3="%d" pid="{}" p1="%d" p2="%d" p3="%d"/>\n'


SHORTEST_BEAM = 1e-3
"""mm; two ends nearer than that are one place to the whole product."""


@dataclass(frozen=True, eq=False)
class Palette:
    """The colours of a body's triangles, 0xRRGGBBAA, ascending, and the id of their group in the file."""

    group: int
    colours: NDArray[np.int64]


def check_geometry(body: Body) -> None:
    """Raise AmprepError for a mesh that 3MF cannot hold: empty, not finite, bad or repeated indices."""
    vertices, triangles = body.mesh.vertices, body.mesh.triangles
    if body.beams is not None:
        _check_beams(body.name, body.beams)
        if not len(triangles):
            return
    if not len(triangles):
        raise AmprepError(f"cannot write {body.name!r}: it has no triangles")
    if not np.isfinite(vertices).all() or np.abs(vertices).max() >= 1e9:
        raise AmprepError(f"cannot write {body.name!r}: it has coordinates beyond 1e9 mm or not finite")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise AmprepError(f"cannot write {body.name!r}: a triangle refers to a vertex that is not there")
    if (triangles == np.roll(triangles, 1, axis=1)).any():
        raise AmprepError(f"cannot write {body.name!r}: a triangle has the same vertex twice")


def _check_beams(name: str, beams: BeamSet) -> None:
    """Raise AmprepError for beams that 3MF cannot hold."""
    nodes, struts, radii = beams.nodes, beams.struts, beams.radii
    if not len(struts) or struts.min() < 0 or struts.max() >= len(nodes):
        raise AmprepError(f"cannot write {name!r}: it has no beams, or one between nodes that are not there")
    if not np.isfinite(nodes).all() or np.abs(nodes).max() >= 1e9:
        raise AmprepError(f"cannot write {name!r}: it has nodes beyond 1e9 mm or not finite")
    if not (np.isfinite(radii) & (radii > 0.0)).all():
        raise AmprepError(f"cannot write {name!r}: it has a beam whose radius is not above 0")
    if (np.linalg.norm(nodes[struts[:, 0]] - nodes[struts[:, 1]], axis=1) < SHORTEST_BEAM).any():
        raise AmprepError(f"cannot write {name!r}: it has a beam shorter than {SHORTEST_BEAM:g} mm")


def mesh_text(body: Body, palette: Palette | None, object_ids: Sequence[int] = ()) -> Iterator[bytes]:
    """Yield the body's ``<mesh>`` element in chunks; `object_ids` are those of the bodies before it.

    lib3mf's own writer scales coordinates by 10^6 in float32, which changes one in sixteen of them.
    """
    yield b"<mesh><vertices>\n"
    vertices = np.round(body.mesh.vertices, 6) + 0.0  # adding zero turns -0 into 0
    yield from _rows(_VERTEX, vertices)
    if body.beams is not None:
        yield from _rows(_VERTEX, np.round(body.beams.nodes, 6) + 0.0)
    yield b"</vertices>"
    if not len(body.mesh.triangles) and body.beams is not None:
        yield from _beams_text(body.beams, 0, object_ids)
        yield b"</mesh>"
        return
    yield b"<triangles>\n"
    if palette is None:
        yield from _rows(_TRIANGLE, body.mesh.triangles)
    else:
        yield from _coloured_triangles(body, palette)
    yield b"</triangles>"
    if body.beams is not None:
        yield from _beams_text(body.beams, len(body.mesh.vertices), object_ids)
    yield b"</mesh>"


def _beams_text(beams: BeamSet, first: int, object_ids: Sequence[int]) -> Iterator[bytes]:
    """Yield the ``<b:beamlattice>`` element; its nodes are the vertices from `first` on.

    A lattice has one radius that beams need not repeat: the most frequent one.
    """
    values, count = np.unique(beams.radii[:, 0], return_counts=True)
    common = float(values[count.argmax()])
    cut = (
        ""
        if beams.clipping is None
        else f'clippingmode="inside" clippingmesh="{object_ids[beams.clipping]}" '
    )
    yield (
        f'<b:beamlattice radius="{common:.9g}" minlength="{SHORTEST_BEAM:g}" {cut}'
        f'representationmesh="{object_ids[beams.stand_in]}" cap="sphere"><b:beams>\n'
    ).encode()
    struts = beams.struts.astype(np.int64) + first
    plain = (beams.radii == common).all(axis=1)
    for run in np.split(np.arange(len(struts)), np.flatnonzero(np.diff(plain)) + 1):
        if plain[run[0]]:
            yield from _rows(_BEAM, struts[run])
        else:
            yield from _sized_beams(struts[run], beams.radii[run])
    yield b"</b:beams></b:beamlattice>"


def _sized_beams(struts: NDArray[np.int64], radii: Floats) -> Iterator[bytes]:
    """Yield beams with radii of their own; runs of one size are formatted at once."""
    changes = np.flatnonzero((radii[1:] != radii[:-1]).any(axis=1)) + 1
    for run in np.split(np.arange(len(struts)), changes):
        first, second = radii[run[0]].tolist()
        yield from _rows(_SIZED.format(first, second), struts[run])


def text_size(body: Body) -> int:
    """Return a number of bytes that the body's text does not exceed."""
    beams = 0 if body.beams is None else 80 * len(body.beams.nodes) + 100 * len(body.beams.struts)
    return 80 * len(body.mesh.vertices) + 150 * len(body.mesh.triangles) + beams + 1000


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
