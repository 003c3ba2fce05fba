"""Documents for the target `prusaslicer`: each group of parts and supports is one merged mesh.

PrusaSlicer 2.5.0 refuses every item or component whose type is not `model`, and moves separate objects apart.
Therefore a support stays with its part only as a volume of the same mesh.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from amprep.arrays import Floats
from amprep.model.build import Build
from amprep.model.mesh import Mesh, join_meshes
from amprep.model.part import Appearance, Part
from amprep.threemf.build.identifier import object_name, title_of
from amprep.threemf.build.values import JsonObject, plain, xml_text
from amprep.threemf.names import PRUSASLICER_NAMESPACE
from amprep.threemf.slicer_volumes import PRUSASLICER_NAMES, SlicerVolume
from amprep.threemf.transforms import from_origin, inverse, round_as_stored, transform_exactly
from amprep.threemf.write.document import (
    BuildItem,
    Document,
    MeshObject,
    Metadata,
    PartGroup,
    PlacedObject,
    group_parts,
)
from amprep.threemf.write.metadata import (
    build_metadata,
    distinct_parts,
    item_metadata,
    part_metadata,
    placed_part_record,
    support_record,
)


def merged_document(build: Build) -> Document:
    """Return the document of a build: one object per group, in the coordinates of the group's first part."""
    parts, title = distinct_parts(build), title_of(build)
    objects: list[MeshObject] = []
    items: list[BuildItem] = []
    shared: dict[Part, int] = {}  # copies without supports are instances of one object
    for group in group_parts(build):
        part = build.parts[group.parts[0]].part
        alone = len(group.parts) + len(group.supports) == 1
        index = shared.get(part, len(objects)) if alone else len(objects)
        merged, item = _merged(build, parts, group, index, title)
        if index == len(objects):
            objects.append(merged)
        if alone:
            shared[part] = index
        items.append(item)
    metadata = ((PRUSASLICER_NAMESPACE, "Version3mf", "1"), *build_metadata(build, parts))
    return Document(build.settings.build_id, metadata, tuple(objects), tuple(items))


def _merged(
    build: Build, parts: Sequence[Part], group: PartGroup, index: int, title: str
) -> tuple[MeshObject, BuildItem]:
    """Return the merged object of a group, which has this index in the file, and the item that places it."""
    first = build.parts[group.parts[0]]
    frame = first.matrix.astype(np.float32).astype(np.float64)  # readers of the file work with float32
    to_frame = inverse(frame)
    meshes = [first.part.mesh]
    records = [placed_part_record(build, group.parts[0], parts, first.part.mesh.digest)]
    for number in group.parts[1:]:
        mesh, entry = _further_part(build, parts, number, to_frame)
        meshes.append(mesh)
        records.append(entry)
    for number in group.supports:
        mesh = build.supports[number].mesh
        meshes.append(Mesh(transform_exactly(mesh.vertices, to_frame), mesh.triangles))
        records.append(support_record(build, number, meshes[-1].digest))
    labels = [build.parts[number].label for number in group.parts]
    own_parts = [build.parts[number].part for number in group.parts]
    merged = MeshObject(
        object_name(" + ".join(labels), title),
        join_meshes(meshes),
        part_number=first.part.part_number,
        appearance=_joined_appearance(own_parts, meshes),
        metadata=_joined_metadata(own_parts),
        volumes=_volumes(labels + [build.supports[number].name for number in group.supports], meshes),
    )
    counted = [
        {**entry, "vertices": len(mesh.vertices), "triangles": len(mesh.triangles)}
        for entry, mesh in zip(records, meshes, strict=True)
    ]
    on_bed = from_origin(frame, build.settings.plate_origin)
    return merged, BuildItem((PlacedObject(index, on_bed),), item_metadata(counted))


def _further_part(
    build: Build, parts: Sequence[Part], number: int, to_frame: Floats
) -> tuple[Mesh, JsonObject]:
    """Return a part's mesh in the coordinates of its group, and its record with the way back.

    The mesh is rounded as the file stores it before it is transformed back. The recorded digest is therefore that
    of the mesh which a reader gets.
    """
    placed = build.parts[number]
    into = to_frame @ placed.matrix
    back = inverse(into)
    mesh = Mesh(transform_exactly(placed.part.mesh.vertices, into), placed.part.mesh.triangles)
    restored = Mesh(transform_exactly(round_as_stored(mesh.vertices), back), mesh.triangles)
    entry = placed_part_record(build, number, parts, restored.digest)
    return mesh, {**entry, "to_part": plain(back.reshape(-1))}


def _joined_appearance(parts: Sequence[Part], meshes: Sequence[Mesh]) -> Appearance:
    """Return the first part's colour and material, and the triangle colours of all meshes (-1: none)."""
    appearances = [part.appearance for part in parts] + [Appearance()] * (len(meshes) - len(parts))
    colours = None
    if any(each.triangle_colours is not None for each in appearances):
        colours = np.concatenate(
            [
                np.full((len(mesh.triangles), 3), -1)
                if each.triangle_colours is None
                else each.triangle_colours
                for each, mesh in zip(appearances, meshes, strict=True)
            ]
        ).astype(np.int64)
    return Appearance(appearances[0].colour, appearances[0].material, colours)


def _joined_metadata(parts: Sequence[Part]) -> Metadata:
    """Return the metadata of all parts; the first part's entry is kept if several have the same name."""
    entries = {entry[:2]: entry for part in reversed(parts) for entry in part_metadata(part)}
    return tuple(entries.values())


def _volumes(names: Sequence[str], meshes: Sequence[Mesh]) -> tuple[SlicerVolume, ...]:
    ends = np.cumsum([0] + [len(mesh.triangles) for mesh in meshes]).tolist()
    return tuple(
        SlicerVolume(name, start, end - 1) for name, (start, end) in zip(names, pairwise(ends), strict=True)
    )


def prusaslicer_config(objects: Sequence[MeshObject], object_ids: Sequence[int]) -> bytes:
    """Return PrusaSlicer's list of objects and volumes; a support is a volume that is printed as it is.

    Parameters
    ----------
    object_ids
        The id of each object in the file.
    """
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', "<config>"]
    for each, number in zip(objects, object_ids, strict=True):
        lines += [f' <object id="{number}">', "  " + _entry("object", "name", each.name)]
        for volume in each.volumes:
            lines += [
                f'  <volume firstid="{volume.first}" lastid="{volume.last}">',
                "   " + _entry("volume", "name", volume.name),
                "   " + _entry("volume", "volume_type", PRUSASLICER_NAMES[volume.kind]),
                "  </volume>",
            ]
        lines.append(" </object>")
    return "\n".join([*lines, "</config>", ""]).encode()


def _entry(kind: str, key: str, value: Any) -> str:
    return f'<metadata type="{kind}" key="{key}" value={quoteattr(xml_text(value))}/>'
