"""The objects and build items of a 3MF file to be written; every dialect makes the same records."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from amprep.arrays import Floats, Ints
from amprep.errors import AmprepError
from amprep.model.build import Build, Lattice
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance
from amprep.threemf.slicer_volumes import SlicerVolume

ObjectType = Literal["model", "surface", "solidsupport", "support"]

Metadata = tuple[tuple[str, str, str], ...]
"""Namespace, name and value of each entry."""


@dataclass(frozen=True, eq=False)
class BeamSet:
    """The beams of a mesh object.

    Attributes
    ----------
    nodes, struts, radii
        ``(n, 3)`` mm, ``(m, 2)``, and ``(m, 2)`` mm at both ends.
    stand_in
        Index of an earlier object: the mesh for readers that do not know beams.
    clipping
        Index of an earlier object outside which beams are clipped; None if nothing clips them.
    """

    nodes: Floats
    struts: Ints
    radii: Floats
    stand_in: int
    clipping: int | None = None


@dataclass(frozen=True, eq=False)
class MeshObject:
    """A mesh object.

    Attributes
    ----------
    appearance
        Its `triangle_colours` may be of a signed type; a negative value leaves the corner uncoloured.
    volumes
        The volumes that PrusaSlicer shows.
    beams
        Beams in addition to the mesh, which may be empty if there are any.
    """

    name: str
    mesh: Mesh
    type: ObjectType = "model"
    part_number: str = ""
    appearance: Appearance = field(default_factory=Appearance)
    metadata: Metadata = ()
    volumes: tuple[SlicerVolume, ...] = ()
    beams: BeamSet | None = None


@dataclass(frozen=True, eq=False)
class PlacedObject:
    """An object, by its index, and its ``(4, 4)`` placement: object coordinates to build coordinates."""

    index: int
    matrix: Floats


@dataclass(frozen=True, eq=False)
class BuildItem:
    """A build item.

    Attributes
    ----------
    objects
        The objects that the item places.
    group
        Name of the components object that contains them; empty if the item places a single object itself.
    """

    objects: tuple[PlacedObject, ...]
    metadata: Metadata
    group: str = ""


@dataclass(frozen=True, eq=False)
class Document:
    """The contents of a file in their order; all identifiers follow from `name`."""

    name: str
    metadata: Metadata
    objects: tuple[MeshObject, ...]
    items: tuple[BuildItem, ...]


@dataclass(frozen=True)
class PartGroup:
    """Indices of placed parts, and of the supports that hold them, in ascending order."""

    parts: tuple[int, ...]
    supports: tuple[int, ...]


def group_parts(build: Build) -> list[PartGroup]:
    """Return groups of parts that share supports; each part is in one group, ordered by their first parts.

    Raises
    ------
    AmprepError
        If a support holds no part, or one that is not in the build.
    """
    leader = list(range(len(build.parts)))
    for support in build.supports:
        held = set(support.parts)
        if not held or not held <= set(range(len(leader))):
            raise AmprepError(
                f"support {support.name!r} must hold parts of its build, it holds {support.parts}"
            )
        joined = {leader[part] for part in held}
        leader = [min(joined) if first in joined else first for first in leader]
    return [
        PartGroup(
            tuple(part for part, first in enumerate(leader) if first == head),
            tuple(i for i, support in enumerate(build.supports) if leader[support.parts[0]] == head),
        )
        for head in sorted(set(leader))
    ]


def beam_objects(
    name: str, lattice: Lattice, clipping: tuple[str, Mesh] | None, first: int
) -> tuple[Sequence[MeshObject], BeamSet]:
    """Return the objects that the beams of a body need, and the beams that refer to them.

    Parameters
    ----------
    name
        Name of the body.
    lattice
        Its beams, with the mesh for readers that do not know beams.
    clipping
        Name and mesh of the solid that clips the beams, if there is one.
    first
        Index of the first of the returned objects in the file.
    """
    objects = [MeshObject(f"mesh of {name}", lattice.stand_in)]
    if clipping is not None:
        objects.append(MeshObject(*clipping))
    beams = BeamSet(
        lattice.nodes, lattice.struts, lattice.radii, first, None if clipping is None else first + 1
    )
    return objects, beams
