"""Writing parts as a job: where their file put them, with what it asked of them, to be packed or sliced next."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from amprep import __version__
from amprep.arrays import Floats
from amprep.model.build import Lattice, Target
from amprep.model.mesh import Mesh
from amprep.model.part import Orientations, Part
from amprep.threemf.build.record import NAMESPACE
from amprep.threemf.write import write_document
from amprep.threemf.write.document import BeamSet, Body, Document, Instance, Item, Metadata, Volume
from amprep.threemf.write.metadata import part_metadata
from amprep.threemf.write.prusaslicer import SLICER_NAMESPACE

_KINDS = {"blocker": "SupportBlocker", "enforcer": "SupportEnforcer"}


def write_parts(
    parts: Sequence[Part],
    path: Path,
    *,
    title: str,
    target: Target = "generic",
    lattices: Mapping[int, tuple[Lattice, Mesh]] | None = None,
) -> None:
    """Write parts as 3MF: every part at each of its positions, with name, colours, material, quantity and value.

    For PrusaSlicer, blockers and enforcers that are meshes become volumes of their parts; other files cannot
    hold them. Equal parts give equal bytes.

    Parameters
    ----------
    lattices
        Index of a part -> what it is written as instead of its mesh: solid and beams, and the closed mesh that
        cuts the beams off.

    Raises
    ------
    AmprepError
        If the file cannot be written, or a mesh is nothing that 3MF can hold.
    """
    bodies: list[Body] = []
    items: list[Item] = []
    for index, part in enumerate(parts):
        lattice = (lattices or {}).get(index)
        bodies += _aids(part, *lattice) if lattice else []
        bodies.append(_body(part, target, lattice[0] if lattice else None, len(bodies)))
        items += [Item((Instance(len(bodies) - 1, _moved(at)),), ()) for at in _positions(part)]
    metadata: Metadata = (("", "Title", title), ("", "Application", f"amprep {__version__}"))
    slicer = target == "prusaslicer"
    if slicer:
        metadata = ((SLICER_NAMESPACE, "Version3mf", "1"), *metadata)
    write_document(Document(title, metadata, tuple(bodies), tuple(items)), path, slicer=slicer)


def _positions(part: Part) -> Floats:
    return np.zeros((1, 3)) if part.positions is None else part.positions


def _moved(position: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = position
    return matrix


def _aids(part: Part, lattice: Lattice, cut: Mesh) -> list[Body]:
    """Return the mesh for readers that know no beams, and what cuts the beams off."""
    return [Body(f"mesh of {part.name}", lattice.stand_in), Body(f"outline of {part.name}", cut)]


def _body(part: Part, target: Target, lattice: Lattice | None, first: int) -> Body:
    """Return the part's object; the aids of its beams are the two bodies before `first`."""
    mesh, beams = part.mesh, None
    volumes: tuple[Volume, ...] = ()
    if lattice is not None:
        mesh = lattice.solids
        beams = BeamSet(lattice.nodes, lattice.struts, lattice.radii, first - 2, first - 1)
    elif target == "prusaslicer":
        mesh, volumes = _with_volumes(part)
    return Body(
        part.name,
        mesh,
        "model" if part.is_solid else "surface",
        part_number=part.part_number,
        appearance=part.appearance,
        metadata=(*part_metadata(part), *_wishes(part)),
        volumes=volumes,
        beams=beams,
    )


def _with_volumes(part: Part) -> tuple[Mesh, tuple[Volume, ...]]:
    """Return the part's mesh joined with those of its blockers and enforcers, and which triangles are whose."""
    regions = [each for each in part.regions if each.kind in _KINDS and each.triangles is None and each.mesh]
    meshes = [part.mesh, *(each.mesh for each in regions if each.mesh)]
    kinds = [(part.name, "ModelPart"), *((each.name, _KINDS[each.kind]) for each in regions)]
    points = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    ends = np.cumsum([0] + [len(mesh.triangles) for mesh in meshes]).tolist()
    joined = Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, points[:-1], strict=True)]),
    )
    volumes = [Volume(name, ends[i], ends[i + 1] - 1, kind) for i, (name, kind) in enumerate(kinds)]
    return joined, tuple(volumes)


def _wishes(part: Part) -> Metadata:
    """Return what a job asks of a part, as a 3MF job says it."""
    copies = part.quantity // len(_positions(part))
    turns = part.orientations
    words = json.dumps(turns.matrices.tolist()) if turns.freedom == "list" else turns.freedom
    wishes = {
        "quantity": str(copies) if copies > 1 else "",
        "value": "" if part.value is None else f"{part.value:.17g}",
        "rotations": "" if _is_usual(turns) else words,
    }
    return tuple((NAMESPACE, name, value) for name, value in wishes.items() if value)


def _is_usual(turns: Orientations) -> bool:
    return turns.freedom == "list" and np.array_equal(turns.matrices, np.eye(3)[None])
