"""Write meshes and beams as 3MF text, with the same rounding of coordinates as `Mesh.digest`."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.errors import AmprepError
from amprep.threemf.write.document import BeamSet, MeshObject

_CHUNK = 20_000
"""Elements in a chunk of text."""
_VERTEX = '<vertex x="%.6f" y="%.6f" z="%.6f"/>\n'
_TRIANGLE = '<triangle v1="%d" v2="%d" v3="%d"/>\n'
_BEAM = '<b:beam v1="%d" v2="%d"/>\n'
_SIZED = '<b:beam v1="%d" v2="%d" r1="{:.9g}" r2="{:.9g}"/>\n'
_COLOURED = '<triangle v1="%d" v2="%d" v3="%d" pid="{}" p1="%d" p2="%d" p3="%d"/>\n'


SHORTEST_BEAM = 1e-3
"""Shortest beam in mm; points nearer than that are the same point everywhere in amprep."""
LARGEST_COORDINATE = 1e9
"""Limit of coordinates in mm."""


@dataclass(frozen=True, eq=False)
class Palette:
    """The colours of an object's triangles, 0xRRGGBBAA in ascending order, and the id of their group in the file."""

    group: int
    colours: NDArray[np.int64]


def check_geometry(thing: MeshObject) -> None:
    """Refuse a mesh object that 3MF cannot store.

    Raises
    ------
    AmprepError
        If it is empty, has coordinates that are too large or not finite, or invalid or repeated indices.
    """
    vertices, triangles = thing.mesh.vertices, thing.mesh.triangles
    if thing.beams is not None:
        _check_beams(thing.name, thing.beams)
        if not len(triangles):
            return
    if not len(triangles):
        raise AmprepError(f"cannot write {thing.name!r}: it has no triangles")
    _check_coordinates(thing.name, vertices)
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise AmprepError(f"cannot write {thing.name!r}: a triangle refers to a vertex that does not exist")
    if (triangles == np.roll(triangles, 1, axis=1)).any():
        raise AmprepError(f"cannot write {thing.name!r}: a triangle has the same vertex twice")


def _check_coordinates(name: str, points: Floats) -> None:
    if not np.isfinite(points).all() or np.abs(points).max() >= LARGEST_COORDINATE:
        raise AmprepError(f"cannot write {name!r}: it has coordinates beyond 1e9 mm or not finite")


def _check_beams(name: str, beams: BeamSet) -> None:
    nodes, struts, radii = beams.nodes, beams.struts, beams.radii
    if not len(struts) or struts.min() < 0 or struts.max() >= len(nodes):
        raise AmprepError(
            f"cannot write {name!r}: it has no beams, or a beam refers to a node that does not exist"
        )
    _check_coordinates(name, nodes)
    if not (np.isfinite(radii) & (radii > 0.0)).all():
        raise AmprepError(f"cannot write {name!r}: a beam's radius must be above 0")
    if (np.linalg.norm(nodes[struts[:, 0]] - nodes[struts[:, 1]], axis=1) < SHORTEST_BEAM).any():
        raise AmprepError(f"cannot write {name!r}: it has a beam shorter than {SHORTEST_BEAM:g} mm")


def mesh_text(thing: MeshObject, palette: Palette | None, object_ids: Sequence[int] = ()) -> Iterator[bytes]:
    """Yield the ``<mesh>`` element of an object in chunks.

    lib3mf's own writer scales coordinates by 10^6 in float32, which changes one in sixteen of them.

    Parameters
    ----------
    palette
        The colours of its triangles, if it has any.
    object_ids
        Ids of all objects in the file, to which beams refer.
    """
    mesh, beams = thing.mesh, thing.beams
    yield b"<mesh><vertices>\n"
    yield from _vertices(mesh.vertices)
    if beams is not None:
        yield from _vertices(beams.nodes)
    yield b"</vertices>"
    if len(mesh.triangles) or beams is None:
        yield b"<triangles>\n"
        if palette is None:
            yield from _rows(_TRIANGLE, mesh.triangles)
        else:
            yield from _coloured_triangles(thing, palette)
        yield b"</triangles>"
    if beams is not None:
        yield from _beams_text(beams, len(mesh.vertices) if len(mesh.triangles) else 0, object_ids)
    yield b"</mesh>"


def _vertices(points: Floats) -> Iterator[bytes]:
    yield from _rows(_VERTEX, np.round(points, 6) + 0.0)  # adding zero turns -0 into 0


def _beams_text(beams: BeamSet, first: int, object_ids: Sequence[int]) -> Iterator[bytes]:
    """Yield the ``<b:beamlattice>`` element; its nodes are the vertices from index `first`.

    Beams may omit the lattice's common radius; the most frequent radius is chosen for it.
    """
    values, count = np.unique(beams.radii[:, 0], return_counts=True)
    common = float(values[count.argmax()])
    clipping = (
        ""
        if beams.clipping is None
        else f'clippingmode="inside" clippingmesh="{object_ids[beams.clipping]}" '
    )
    yield (
        f'<b:beamlattice radius="{common:.9g}" minlength="{SHORTEST_BEAM:g}" {clipping}'
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
    """Yield beams with their own radii; runs of equal radii are formatted at once."""
    changes = np.flatnonzero((radii[1:] != radii[:-1]).any(axis=1)) + 1
    for run in np.split(np.arange(len(struts)), changes):
        first, second = radii[run[0]].tolist()
        yield from _rows(_SIZED.format(first, second), struts[run])


def text_size(thing: MeshObject) -> int:
    """Return an upper bound of the object's text in bytes."""
    beams = 0 if thing.beams is None else 80 * len(thing.beams.nodes) + 100 * len(thing.beams.struts)
    return 80 * len(thing.mesh.vertices) + 150 * len(thing.mesh.triangles) + beams + 1000


def _coloured_triangles(thing: MeshObject, palette: Palette) -> Iterator[bytes]:
    """Yield the triangles in their order, in runs with and without colours."""
    colours = np.asarray(thing.appearance.triangle_colours).astype(np.int64)
    rows = np.hstack([thing.mesh.triangles, np.searchsorted(palette.colours, colours)])
    uncoloured = np.asarray((colours < 0).any(axis=1))
    for run in np.split(np.arange(len(rows)), np.flatnonzero(np.diff(uncoloured)) + 1):
        if uncoloured[run[0]]:
            yield from _rows(_TRIANGLE, rows[run, :3])
        else:
            yield from _rows(_COLOURED.format(palette.group), rows[run])


def _rows(
    template: str, rows: NDArray[np.float64] | NDArray[np.int64] | NDArray[np.int32]
) -> Iterator[bytes]:
    for start in range(0, len(rows), _CHUNK):
        chunk = rows[start : start + _CHUNK]
        yield (template * len(chunk) % tuple(chunk.ravel().tolist())).encode()
