"""The dialects `generic` and `cura`: meshes as objects of their own, each group in one components object."""

from collections.abc import Sequence

import numpy as np

from amprep.model.build import Build, SupportBody
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.threemf.build import record
from amprep.threemf.write.document import (
    BeamSet,
    Body,
    Document,
    Group,
    Instance,
    Item,
    ObjectKind,
    groups_of,
)
from amprep.threemf.write.metadata import (
    build_metadata,
    distinct_parts,
    part_metadata,
    part_piece,
    pieces_metadata,
    recorded,
    support_piece,
)

_CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
_SIDES = (
    *((0, 2, 3), (0, 3, 1), (4, 7, 6), (4, 5, 7), (0, 1, 5), (0, 5, 4)),
    *((2, 7, 3), (2, 6, 7), (0, 4, 6), (0, 6, 2), (1, 7, 5), (1, 3, 7)),
)

CURA_NAMESPACE = "http://software.ultimaker.com/xml/cura/3mf/2015/10"


def components_document(build: Build) -> Document:
    """Return the file: the mesh of a part is shared by its copies, supports stay in build coordinates."""
    groups, parts = groups_of(build), distinct_parts(build)
    bodies = [_part_body(part) for part in parts]
    places = []
    for support in build.supports:
        aids = _aids(build, support)
        first = len(bodies)
        bodies += [*aids, _support_body(build, support, range(first, first + len(aids)))]
        places.append(len(bodies) - 1)
    items = [_item(build, parts, group, places) for group in groups]
    return Document(build.settings.build_id, build_metadata(build, parts), tuple(bodies), tuple(items))


def _part_body(part: Part) -> Body:
    """Return the part's object; of type `surface` where the user allowed a mesh that is no solid."""
    return Body(
        part.name,
        part.mesh,
        "model" if part.is_solid else "surface",
        part_number=part.part_number,
        appearance=part.appearance,
        metadata=part_metadata(part),
    )


def _has_beams(build: Build, support: SupportBody) -> bool:
    """Tell whether the file has beams for a support: slicers know none."""
    return support.lattice is not None and build.settings.target == "generic"


def _aids(build: Build, support: SupportBody) -> list[Body]:
    """Return what beams need beside them: the mesh for readers that know none, and what they are cut off by."""
    lattice = support.lattice
    if lattice is None or not _has_beams(build, support):
        return []
    aids = [Body(f"mesh of {support.name}", lattice.stand_in)]
    if lattice.room is not None:
        low, high = lattice.room
        aids.append(Body(f"room of {support.name}", Mesh(low + _CUBE * (high - low), np.array(_SIDES))))
    return aids


def _support_body(build: Build, support: SupportBody, aids: Sequence[int]) -> Body:
    """Return the support's object; `aids` are the bodies that its beams need beside them.

    A surface must not be filled, which only the type `support` says.
    """
    holds = ", ".join(build.parts[part].label for part in support.parts)
    metadata = recorded(record.HOLDS, holds)
    if build.settings.target == "cura":
        metadata += ((CURA_NAMESPACE, "support_mesh", "True"),)
    kind: ObjectKind = "support" if support.surface else "solidsupport"
    if build.settings.target == "generic" and build.settings.supports_as == "model" and not support.surface:
        kind = "model"
    lattice = support.lattice
    if lattice is None or not _has_beams(build, support):
        return Body(support.name, support.mesh, kind, metadata=metadata)
    beams = BeamSet(lattice.nodes, lattice.struts, lattice.radii, *aids)
    return Body(support.name, lattice.solids, kind, metadata=metadata, beams=beams)


def _item(build: Build, parts: Sequence[Part], group: Group, places: Sequence[int]) -> Item:
    placed = [build.parts[index] for index in group.parts]
    instances = [Instance(parts.index(each.part), each.matrix) for each in placed]
    instances += [Instance(places[index], np.eye(4)) for index in group.supports]
    pieces = [part_piece(build, index, parts, build.parts[index].part.mesh.digest) for index in group.parts]
    pieces += [support_piece(build, index) for index in group.supports]
    name = " + ".join(each.label for each in placed)
    return Item(tuple(instances), pieces_metadata(pieces), f"{name} ({build.settings.build_id})")
