"""The dialect `prusaslicer`: a support stays with its part only as a volume of one and the same mesh.

PrusaSlicer 2.5.0 refuses every item or component that is not of type `model`, and scatters separate objects.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from amprep.arrays import Floats
from amprep.model.build import Build
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance, Part
from amprep.threemf.build.values import Record, plain, xml_text
from amprep.threemf.write.document import Body, Document, Group, Instance, Item, Metadata, Volume, groups_of
from amprep.threemf.write.metadata import (
    build_metadata,
    distinct_parts,
    part_metadata,
    part_piece,
    pieces_metadata,
    support_piece,
)

SLICER_NAMESPACE = "http://schemas.slic3r.org/3mf/2017/06"
CONFIG_NAME = "Metadata/Slic3r_PE_model.config"


def moved_exactly(vertices: Floats, matrix: Floats) -> Floats:
    """Return the vertices under the matrix, the same bits on every machine (a BLAS may differ in the last).

    Parameters
    ----------
    vertices
        ``(n, 3)`` mm.
    matrix
        ``(4, 4)`` affine, column vectors.
    """
    x, y, z = vertices.T
    rows = [a * x + b * y + c * z + d for a, b, c, d in matrix[:3].tolist()]
    return np.stack(rows, axis=1)


def inverse(matrix: Floats) -> Floats:
    """Return the inverse of a ``(4, 4)`` matrix; raises ValueError (LinAlgError) if it has none."""
    return np.asarray(np.linalg.inv(matrix), dtype=np.float64)


def rounded_as_kept(vertices: Floats) -> Floats:
    """Return the vertices as they come back from a file: float32 of six decimals."""
    return np.round(vertices, 6).astype(np.float32).astype(np.float64)


def merged_document(build: Build) -> Document:
    """Return the file: one object for each group, in the coordinates of its first part."""
    parts = distinct_parts(build)
    bodies: list[Body] = []
    items: list[Item] = []
    shared: dict[Part, int] = {}  # copies without supports are instances of one object
    for group in groups_of(build):
        part = build.parts[group.parts[0]].part
        alone = len(group.parts) + len(group.supports) == 1
        body, item = _merged(build, parts, group, shared.get(part, len(bodies)) if alone else len(bodies))
        if item.instances[0].body == len(bodies):
            bodies.append(body)
        if alone:
            shared[part] = item.instances[0].body
        items.append(item)
    metadata = ((SLICER_NAMESPACE, "Version3mf", "1"), *build_metadata(build, parts))
    return Document(build.settings.build_id, metadata, tuple(bodies), tuple(items))


def _merged(build: Build, parts: Sequence[Part], group: Group, index: int) -> tuple[Body, Item]:
    """Return the object of a group, body `index` of the file, and the item that places it."""
    first = build.parts[group.parts[0]]
    frame = first.matrix.astype(np.float32).astype(np.float64)  # what readers of the file work with
    to_frame = inverse(frame)
    meshes, pieces = [first.part.mesh], [part_piece(build, group.parts[0], parts, first.part.mesh.digest)]
    for place in group.parts[1:]:
        mesh, piece = _further_part(build, parts, place, to_frame)
        meshes.append(mesh)
        pieces.append(piece)
    for place in group.supports:
        mesh = build.supports[place].mesh
        meshes.append(Mesh(moved_exactly(mesh.vertices, to_frame), mesh.triangles))
        pieces.append(support_piece(build, place))
    names = [build.parts[place].label for place in group.parts]
    body = Body(
        f"{' + '.join(names)} ({build.settings.build_id})",
        _joined(meshes),
        part_number=first.part.part_number,
        appearance=_joined_appearance([build.parts[place].part for place in group.parts], meshes),
        metadata=_joined_metadata([build.parts[place].part for place in group.parts]),
        volumes=_volumes(names + [build.supports[place].name for place in group.supports], meshes),
    )
    counted = [
        {**piece, "vertices": len(mesh.vertices), "triangles": len(mesh.triangles)}
        for piece, mesh in zip(pieces, meshes, strict=True)
    ]
    return body, Item((Instance(index, frame),), pieces_metadata(counted))


def _further_part(build: Build, parts: Sequence[Part], place: int, to_frame: Floats) -> tuple[Mesh, Record]:
    """Return a part in the coordinates of its group, and the record that brings it back to its own.

    Both ways round to what a file keeps, so the digest is that of the mesh which a reader gets.
    """
    placed = build.parts[place]
    into = to_frame @ placed.matrix
    back = inverse(into)
    mesh = Mesh(moved_exactly(placed.part.mesh.vertices, into), placed.part.mesh.triangles)
    restored = Mesh(moved_exactly(rounded_as_kept(mesh.vertices), back), mesh.triangles)
    piece = part_piece(build, place, parts, restored.digest)
    return mesh, {**piece, "to_part": plain(back.reshape(-1))}


def _joined(meshes: Sequence[Mesh]) -> Mesh:
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    triangles = [mesh.triangles + start for mesh, start in zip(meshes, starts[:-1], strict=True)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(triangles))


def _joined_appearance(parts: Sequence[Part], meshes: Sequence[Mesh]) -> Appearance:
    """Return the first part's colour and material, and the triangle colours of all (-1: none)."""
    looks = [part.appearance for part in parts] + [Appearance()] * (len(meshes) - len(parts))
    colours = None
    if any(look.triangle_colours is not None for look in looks):
        colours = np.concatenate(
            [
                np.full((len(mesh.triangles), 3), -1)
                if look.triangle_colours is None
                else look.triangle_colours
                for look, mesh in zip(looks, meshes, strict=True)
            ]
        ).astype(np.int64)
    return Appearance(looks[0].colour, looks[0].material, colours)


def _joined_metadata(parts: Sequence[Part]) -> Metadata:
    """Return the metadata of all parts; of entries with the same name the first part's is kept."""
    entries = {entry[:2]: entry for part in reversed(parts) for entry in part_metadata(part)}
    return tuple(entries.values())


def _volumes(names: Sequence[str], meshes: Sequence[Mesh]) -> tuple[Volume, ...]:
    ends = np.cumsum([0] + [len(mesh.triangles) for mesh in meshes]).tolist()
    return tuple(
        Volume(name, start, end - 1) for name, (start, end) in zip(names, pairwise(ends), strict=True)
    )


def slicer_config(bodies: Sequence[Body], object_ids: Sequence[int]) -> bytes:
    """Return PrusaSlicer's own list of objects and volumes; supports are volumes to print as they are."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', "<config>"]
    for body, number in zip(bodies, object_ids, strict=True):
        lines += [f' <object id="{number}">', "  " + _entry("object", "name", body.name)]
        for volume in body.volumes:
            lines += [
                f'  <volume firstid="{volume.first}" lastid="{volume.last}">',
                "   " + _entry("volume", "name", volume.name),
                "   " + _entry("volume", "volume_type", volume.kind),
                "  </volume>",
            ]
        lines.append(" </object>")
    return "\n".join([*lines, "</config>", ""]).encode()


def _entry(kind: str, key: str, value: Any) -> str:
    return f'<metadata type="{kind}" key="{key}" value={quoteattr(xml_text(value))}/>'
