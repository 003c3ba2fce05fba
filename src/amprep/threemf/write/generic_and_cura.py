"""Documents for the targets `generic` and `cura`: one object per mesh, one components object per group."""

from collections.abc import Sequence

import numpy as np

from amprep.model.build import Build, SupportBody
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.threemf.build import record
from amprep.threemf.build.identifier import object_name, title_of
from amprep.threemf.names import CURA_NAMESPACE
from amprep.threemf.write.document import (
    BeamSet,
    BuildItem,
    Document,
    MeshObject,
    ObjectType,
    PartGroup,
    PlacedObject,
    beam_objects,
    group_parts,
)
from amprep.threemf.write.geometry import check_geometry
from amprep.threemf.write.metadata import (
    build_metadata,
    distinct_parts,
    item_metadata,
    own_metadata,
    part_metadata,
    placed_part_record,
    support_record,
)

_BOX_CORNERS = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
_BOX_TRIANGLES = (
    *((0, 2, 3), (0, 3, 1), (4, 7, 6), (4, 5, 7), (0, 1, 5), (0, 5, 4)),
    *((2, 7, 3), (2, 6, 7), (0, 4, 6), (0, 6, 2), (1, 7, 5), (1, 3, 7)),
)


def components_document(build: Build) -> Document:
    """Return the document of a build; copies of a part share its mesh, supports are in build coordinates.

    Raises
    ------
    AmprepError
        If 3MF cannot store an object.
    """
    groups, parts = group_parts(build), distinct_parts(build)
    objects = [_part_object(part) for part in parts]
    support_objects = []
    for support in build.supports:
        objects += _support_objects(build, support, len(objects))
        support_objects.append(len(objects) - 1)
    for each in objects:  # digests need indices in range
        check_geometry(each)
    title = title_of(build)
    items = [_item(build, parts, group, support_objects, title) for group in groups]
    return Document(build.settings.build_id, build_metadata(build, parts), tuple(objects), tuple(items))


def _part_object(part: Part) -> MeshObject:
    """Return the part's object; its type is `surface` if the user allowed a mesh that is not a solid."""
    return MeshObject(
        part.name,
        part.mesh,
        "model" if part.is_solid else "surface",
        part_number=part.part_number,
        appearance=part.appearance,
        metadata=part_metadata(part),
    )


def _support_objects(build: Build, support: SupportBody, first: int) -> list[MeshObject]:
    """Return the support's object, preceded by those that its beams need; the first has index `first`.

    Only a generic file has beams, because slicers do not know them.
    """
    lattice = support.lattice
    if lattice is None or build.settings.target != "generic":
        return [_support_object(build, support, support.mesh)]
    clipping = None
    if lattice.room is not None:
        low, high = lattice.room
        clipping = (
            f"clipping mesh of {support.name}",
            Mesh(low + _BOX_CORNERS * (high - low), np.array(_BOX_TRIANGLES)),
        )
    objects, beams = beam_objects(support.name, lattice, clipping, first)
    return [*objects, _support_object(build, support, lattice.solids, beams)]


def _support_object(
    build: Build, support: SupportBody, mesh: Mesh, beams: BeamSet | None = None
) -> MeshObject:
    """Return the support's object; the type `support` is the only one that forbids to fill a surface.

    Unless told otherwise, Cura fills the space below a support down to the plate.
    """
    metadata = own_metadata(record.HOLDS, ", ".join(build.parts[part].label for part in support.parts))
    if build.settings.target == "cura":
        metadata += (
            (CURA_NAMESPACE, "support_mesh", "True"),
            (CURA_NAMESPACE, "support_mesh_drop_down", "False"),
        )
    kind: ObjectType = "support" if support.surface else "solidsupport"
    if build.settings.target == "generic" and build.settings.supports_as == "model" and not support.surface:
        kind = "model"
    return MeshObject(support.name, mesh, kind, metadata=metadata, beams=beams)


def _digest(build: Build, index: int) -> str:
    support = build.supports[index]
    return support.digest if build.settings.target == "generic" else support.mesh.digest


def _item(
    build: Build, parts: Sequence[Part], group: PartGroup, support_objects: Sequence[int], title: str
) -> BuildItem:
    placed = [build.parts[index] for index in group.parts]
    objects = [PlacedObject(parts.index(each.part), each.matrix) for each in placed]
    objects += [PlacedObject(support_objects[index], np.eye(4)) for index in group.supports]
    records = [
        placed_part_record(build, index, parts, build.parts[index].part.mesh.digest) for index in group.parts
    ]
    records += [support_record(build, index, _digest(build, index)) for index in group.supports]
    name = " + ".join(each.label for each in placed)
    return BuildItem(tuple(objects), item_metadata(records), object_name(name, title))
