"""The objects and items of a 3MF to be, the same records for every dialect."""

from dataclasses import dataclass, field
from typing import Literal

from amprep.arrays import Floats, Ints
from amprep.errors import AmprepError
from amprep.model.build import Build
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance

ObjectKind = Literal["model", "surface", "solidsupport", "support"]

Metadata = tuple[tuple[str, str, str], ...]
"""Namespace, name and value of each entry."""


@dataclass(frozen=True)
class Volume:
    """A named run of triangles of a body, both ends included, that a slicer shows as a volume of its own.

    `kind` is PrusaSlicer's word for what it is for.
    """

    name: str
    first: int
    last: int
    kind: str = "ModelPart"


@dataclass(frozen=True, eq=False)
class BeamSet:
    """The beams of a body; bodies before it that stand in for it, and that may cut it off (indices).

    Attributes
    ----------
    nodes, struts, radii
        ``(n, 3)`` mm, ``(m, 2)`` and ``(m, 2)`` mm at both ends.
    """

    nodes: Floats
    struts: Ints
    radii: Floats
    stand_in: int
    clipping: int | None = None


@dataclass(frozen=True, eq=False)
class Body:
    """One mesh object.

    Attributes
    ----------
    appearance
        Its `triangle_colours` may be of a signed type; a negative value leaves the corner uncoloured.
    beams
        Beams beside the mesh, which may be empty then.
    """

    name: str
    mesh: Mesh
    kind: ObjectKind = "model"
    part_number: str = ""
    appearance: Appearance = field(default_factory=Appearance)
    metadata: Metadata = ()
    volumes: tuple[Volume, ...] = ()
    beams: BeamSet | None = None


@dataclass(frozen=True, eq=False)
class Instance:
    """A body where it stands; `matrix` is ``(4, 4)``, body coordinates to build coordinates."""

    body: int
    matrix: Floats


@dataclass(frozen=True, eq=False)
class Item:
    """One thing on the plate.

    Attributes
    ----------
    group
        Name of the components object that ties the instances together; empty for a single instance that the
        item places itself.
    """

    instances: tuple[Instance, ...]
    metadata: Metadata
    group: str = ""


@dataclass(frozen=True, eq=False)
class Document:
    """All that a file says, in the order in which it says it; `name` seeds its identifiers."""

    name: str
    metadata: Metadata
    bodies: tuple[Body, ...]
    items: tuple[Item, ...]


@dataclass(frozen=True)
class Group:
    """Indices of the placed parts and of the supports that hold them, each ascending."""

    parts: tuple[int, ...]
    supports: tuple[int, ...]


def groups_of(build: Build) -> list[Group]:
    """Return every part in exactly one group, the groups in the order of their first parts.

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
        Group(
            tuple(part for part, first in enumerate(leader) if first == head),
            tuple(i for i, support in enumerate(build.supports) if leader[support.parts[0]] == head),
        )
        for head in sorted(set(leader))
    ]
