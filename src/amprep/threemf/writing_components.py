"""The dialects `generic` and `cura`: meshes as objects of their own, each group in one components object."""

from collections.abc import Sequence

import numpy as np

from amprep.model.build import Build, SupportBody
from amprep.model.part import Part
from amprep.threemf import record
from amprep.threemf.writing_document import Body, Document, Instance, Item, ObjectKind
from amprep.threemf.writing_groups import Group, groups_of
from amprep.threemf.writing_pieces import (
    build_metadata,
    distinct_parts,
    part_metadata,
    part_piece,
    pieces_metadata,
    recorded,
    support_piece,
)

CURA_NAMESPACE = "http://software.ultimaker.com/xml/cura/3mf/2015/10"


def components_document(build: Build) -> Document:
    """Return the file: the mesh of a part is shared by its copies, supports stay in build coordinates."""
    groups, parts = groups_of(build), distinct_parts(build)
    bodies = [_part_body(part) for part in parts] + [
        _support_body(build, support) for support in build.supports
    ]
    items = [_item(build, parts, group) for group in groups]
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


def _support_body(build: Build, support: SupportBody) -> Body:
    """Return the support's object; a surface must not be filled, which only the type `support` says."""
    holds = ", ".join(build.parts[part].label for part in support.parts)
    metadata = recorded(record.HOLDS, holds)
    if build.settings.target == "cura":
        metadata += ((CURA_NAMESPACE, "support_mesh", "True"),)
    kind: ObjectKind = "support" if support.surface else "solidsupport"
    return Body(support.name, support.mesh, kind, metadata=metadata)


def _item(build: Build, parts: Sequence[Part], group: Group) -> Item:
    placed = [build.parts[index] for index in group.parts]
    instances = [Instance(parts.index(each.part), each.matrix) for each in placed]
    instances += [Instance(len(parts) + index, np.eye(4)) for index in group.supports]
    pieces = [part_piece(build, index, parts, build.parts[index].part.mesh.digest) for index in group.parts]
    pieces += [support_piece(build, index) for index in group.supports]
    name = " + ".join(each.label for each in placed)
    return Item(tuple(instances), pieces_metadata(pieces), f"{name} ({build.settings.build_id})")
