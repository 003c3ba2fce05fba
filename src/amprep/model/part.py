"""A part as the job asks for it: mesh, quantity, value, rotations, regions, overrides."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from amprep.arrays import Floats, Ints, frozen
from amprep.model.mesh import Mesh

RegionKind = Literal["blocker", "enforcer", "lattice"]
Freedom = Literal["list", "about-z", "free"]


@dataclass(frozen=True, eq=False)
class Orientations:
    """How a part may be turned: a list of rotation matrices, any angle about z, or freely.

    Attributes
    ----------
    freedom
        ``list`` uses `matrices`; ``about-z`` and ``free`` are continuous and ignore them.
    matrices
        ``(k, 3, 3)`` float64 rotation matrices; the first is the one preferred.
    """

    freedom: Freedom = "list"
    matrices: Floats = field(default_factory=lambda: np.eye(3)[None])

    def __post_init__(self) -> None:
        object.__setattr__(self, "matrices", frozen(self.matrices, np.float64).reshape(-1, 3, 3))


@dataclass(frozen=True, eq=False)
class Region:
    """Marks part of a part: some of its triangles, what lies in a mesh, or pieces painted on triangles.

    Attributes
    ----------
    triangles
        Indices of the part's triangles; alone, they are marked as wholes.
    mesh
        In part coordinates. Alone, a closed mesh that marks what lies in it; with `triangles`, triangle i of
        this mesh is the piece that is painted on the part's triangle ``triangles[i]``.
    """

    kind: RegionKind
    name: str
    triangles: Ints | None = None
    mesh: Mesh | None = None


@dataclass(frozen=True, eq=False)
class Overrides:
    """Settings that hold for one part only; None keeps the job's."""

    overhang_angle_deg: float | None = None
    lift_mm: float | None = None
    clearance_mm: float | None = None
    supports: bool | None = None


@dataclass(frozen=True, eq=False)
class Appearance:
    """What a part looks like and is made of, kept from input to output.

    Attributes
    ----------
    colour
        ``#RRGGBBAA`` of the whole part, or None.
    material
        Name of the base material, or None.
    triangle_colours
        ``(m, 3)`` int64, 0xRRGGBBAA of each triangle's corners, -1 where there is none; or None.
    """

    colour: str | None = None
    material: str | None = None
    triangle_colours: Any | None = None


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh to be printed, as often as `quantity` says.

    Attributes
    ----------
    name
        Unique within a job.
    mesh
        Geometry in part coordinates, mm; never changed after reading.
    volume_mm3
        Volume of the solid; overlapping shells counted once.
    value
        Reward in a fill problem; None means the volume.
    is_solid
        False only when the user allowed a surface that manifold3d refuses.
    boxes
        ``(k, 6)`` x0 y0 z0 x1 y1 z1 given by hand in the job, or None.
    positions
        ``(k, 3)`` mm, where the file puts the part's origin, once for each time its build asks for it; only
        what supports a plate as it lies looks at them. None: one, at the origin.
    fixed
        ``(k, 3)`` mm, least corners of the boxes around the first copies, which stand in the first build already;
        or None.
    notes
        What reading mended or found, one sentence each, shown to the user.
    metadata
        Kept as read: ``(namespace, name) -> value``.
    """

    name: str
    mesh: Mesh
    volume_mm3: float
    quantity: int = 1
    value: float | None = None
    orientations: Orientations = field(default_factory=Orientations)
    regions: tuple[Region, ...] = ()
    overrides: Overrides = field(default_factory=Overrides)
    appearance: Appearance = field(default_factory=Appearance)
    is_solid: bool = True
    boxes: Floats | None = None
    positions: Floats | None = None
    fixed: Floats | None = None
    part_number: str = ""
    source: str = ""
    notes: tuple[str, ...] = ()
    metadata: Mapping[tuple[str, str], str] = field(default_factory=dict)

    @property
    def worth(self) -> float:
        """The value in a fill problem: `value`, or the volume in mm3."""
        return self.volume_mm3 if self.value is None else self.value
