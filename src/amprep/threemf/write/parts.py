"""Write parts as a 3MF job, at their original positions and with their settings, for packing or slicing."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from amprep.arrays import Floats
from amprep.model.build import Lattice, Target
from amprep.model.mesh import Mesh, join_meshes
from amprep.model.part import Orientations, Part
from amprep.threemf.names import NAMESPACE, PRUSASLICER_NAMESPACE
from amprep.threemf.slicer_volumes import SlicerVolume, VolumeKind
from amprep.threemf.write import write_document
from amprep.threemf.write.document import (
    BeamSet,
    BuildItem,
    Document,
    MeshObject,
    Metadata,
    PlacedObject,
    beam_objects,
)
from amprep.threemf.write.metadata import part_metadata, title_metadata

_VOLUME_KINDS: dict[str, VolumeKind] = {"blocker": "blocker", "enforcer": "enforcer"}
"""Kind of the volume by the kind of the region; regions of other kinds are not written."""


def write_parts(
    parts: Sequence[Part],
    path: Path,
    *,
    title: str,
    target: Target = "generic",
    lattices: Mapping[int, tuple[Lattice, Mesh]] | None = None,
) -> None:
    """Write parts as 3MF, each at every of its positions; equal parts give equal bytes.

    Parameters
    ----------
    parts
        Name, colours, material, quantity, value and rotations are written, too.
    path
        The file appears complete; after an error or an interruption it does not appear.
    title
        Title of the file.
    target
        For ``prusaslicer``, blockers and enforcers that are meshes become volumes of their parts; other
        files cannot store them.
    lattices
        Index of a part -> the replacement of its mesh: solids with beams, and the closed mesh that clips the beams.

    Raises
    ------
    AmprepError
        If the file cannot be written, or 3MF cannot store a mesh.
    """
    objects: list[MeshObject] = []
    items: list[BuildItem] = []
    for index, part in enumerate(parts):
        objects += _part_objects(part, target, (lattices or {}).get(index), len(objects))
        items += [BuildItem((PlacedObject(len(objects) - 1, _translation(at)),), ()) for at in part.origins]
    metadata = title_metadata(title)
    if target == "prusaslicer":
        metadata = ((PRUSASLICER_NAMESPACE, "Version3mf", "1"), *metadata)
    document = Document(title, metadata, tuple(objects), tuple(items))
    write_document(document, path, with_volumes=target == "prusaslicer")


def _translation(position: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = position
    return matrix


def _part_objects(
    part: Part, target: Target, lattice: tuple[Lattice, Mesh] | None, first: int
) -> list[MeshObject]:
    """Return the part's object, preceded by those that its beams need; the first has index `first`."""
    if lattice is not None:
        beams, outline = lattice
        needed, beam_set = beam_objects(part.name, beams, (f"outline of {part.name}", outline), first)
        return [*needed, _part_object(part, beams.solids, (), beam_set)]
    return [_part_object(part, *(_with_volumes(part) if target == "prusaslicer" else (part.mesh, ())))]


def _part_object(
    part: Part, mesh: Mesh, volumes: tuple[SlicerVolume, ...], beams: BeamSet | None = None
) -> MeshObject:
    return MeshObject(
        part.name,
        mesh,
        "model" if part.is_solid else "surface",
        part_number=part.part_number,
        appearance=part.appearance,
        metadata=(*part_metadata(part), *_job_metadata(part)),
        volumes=volumes,
        beams=beams,
    )


def _with_volumes(part: Part) -> tuple[Mesh, tuple[SlicerVolume, ...]]:
    """Return the part's mesh joined with those of its blockers and enforcers, and the volume of each."""
    regions = [
        each for each in part.regions if each.kind in _VOLUME_KINDS and each.triangles is None and each.mesh
    ]
    meshes = [part.mesh, *(each.mesh for each in regions if each.mesh)]
    ends = np.cumsum([0] + [len(mesh.triangles) for mesh in meshes]).tolist()
    volumes = [SlicerVolume(part.name, ends[0], ends[1] - 1)]
    volumes += [
        SlicerVolume(each.name, ends[i], ends[i + 1] - 1, _VOLUME_KINDS[each.kind])
        for i, each in enumerate(regions, start=1)
    ]
    return join_meshes(meshes), tuple(volumes)


def _job_metadata(part: Part) -> Metadata:
    """Return the settings of a part as the metadata that `amprep.threemf.read.job_metadata` reads."""
    copies = part.quantity // len(part.origins)
    orientations = part.orientations
    rotations = (
        json.dumps(orientations.matrices.tolist()) if orientations.freedom == "list" else orientations.freedom
    )
    entries = {
        "quantity": str(copies) if copies > 1 else "",
        "value": "" if part.value is None else f"{part.value:.17g}",
        "rotations": "" if _is_default(orientations) else rotations,
    }
    return tuple((NAMESPACE, name, value) for name, value in entries.items() if value)


def _is_default(orientations: Orientations) -> bool:
    return orientations.freedom == "list" and np.array_equal(orientations.matrices, np.eye(3)[None])
