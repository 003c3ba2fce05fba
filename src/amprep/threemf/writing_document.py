"""The objects and items of a 3MF to be, the same records for every dialect."""

from dataclasses import dataclass, field
from typing import Literal

from amprep.model.arrays import Floats, Ints
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
