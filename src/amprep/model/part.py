"""A part of a job: mesh, quantity, value, orientations, regions and settings of its own."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from amprep.arrays import Floats, Ints, frozen
from amprep.model.mesh import Mesh
from amprep.model.orientation import OrientationRules

RegionKind = Literal["blocker", "enforcer", "lattice"]
Freedom = Literal["list", "about-z", "free"]


@dataclass(frozen=True, eq=False)
class Orientations:
    """Allowed orientations of a part: a list of rotation matrices, any angle about z, or any rotation.

    Attributes
    ----------
    freedom
        ``list`` uses `matrices`; ``about-z`` and ``free`` are continuous and ignore them.
    matrices
        ``(k, 3, 3)`` float64 rotation matrices, of which the first is preferred.
    """

    freedom: Freedom = "list"
    matrices: Floats = field(default_factory=lambda: np.eye(3)[None])

    def __post_init__(self) -> None:
        object.__setattr__(self, "matrices", frozen(self.matrices, np.float64).reshape(-1, 3, 3))


@dataclass(frozen=True, eq=False)
class Region:
    """A marked region of a part: some of its triangles, the inside of a mesh, or painted areas of triangles.

    Attributes
    ----------
    triangles
        Indices of triangles of the part; without `mesh`, whole triangles are marked.
    mesh
        Mesh in part coordinates. Without `triangles`, a closed mesh whose inside is marked; with `triangles`, triangle
        i of this mesh is a painted area of the triangle ``triangles[i]`` of the part.
    """

    kind: RegionKind
    name: str
    triangles: Ints | None = None
    mesh: Mesh | None = None


@dataclass(frozen=True, eq=False)
class Overrides:
    """Settings for one part; None keeps the setting of the job.

    Attributes
    ----------
    volumes
        Names of the volume makers, each of which works on the result of the one before.
    territory_margin_mm
        Margin around the shadow of the part in which its supports may be, mm.
    """

    overhang_angle_deg: float | None = None
    lift_mm: float | None = None
    clearance_mm: float | None = None
    supports: bool | None = None
    volumes: tuple[str, ...] | None = None
    territory_margin_mm: float | None = None


@dataclass(frozen=True, eq=False)
class Appearance:
    """Colours and material of a part, which are kept from input to output.

    Attributes
    ----------
    colour
        ``#RRGGBBAA`` of the whole part, or None.
    material
        Name of the base material, or None.
    triangle_colours
        ``(m, 3)`` int64, 0xRRGGBBAA of the corners of each triangle, -1 for no colour; or None.
    """

    colour: str | None = None
    material: str | None = None
    triangle_colours: Any | None = None


@dataclass(frozen=True, eq=False)
class Part:
    """A part to print.

    Attributes
    ----------
    name
        Unique within a job.
    mesh
        Geometry in part coordinates, mm; it is not changed after reading.
    volume_mm3
        Volume of the solid; overlapping shells count once.
    value
        Value in a fill problem; None means the volume.
    is_solid
        False for a mesh that is not a solid, if the user allowed surfaces.
    boxes
        ``(k, 6)`` x0 y0 z0 x1 y1 z1 mm, bounding boxes from the job file; or None.
    positions
        ``(k, 3)`` mm, position of the origin of the part for each of its build items in the file; None means one
        position at the origin. Packing ignores them.
    fixed
        ``(k, 3)`` mm, lowest corners of the bounding boxes of the copies with a fixed position in the first build; or
        None.
    notes
        Repairs and findings of the reader, one sentence each, for the user.
    warnings
        What is wrong with the file or doubtful, one sentence each; the first part of a file has those of the file.
    metadata
        Metadata of the file, ``(namespace, name) -> value``, kept unchanged.
    orient
        Restrictions of the search for orientations, whose proposals take the place of `orientations`; None for no
        search.
    source_sha256
        SHA-256 of the file that the part was read from; empty if there is none.
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
    warnings: tuple[str, ...] = ()
    metadata: Mapping[tuple[str, str], str] = field(default_factory=dict)
    source_sha256: str = ""
    orient: OrientationRules | None = None

    @property
    def origins(self) -> Floats:
        """The positions ``(k, 3)`` mm of the origin of the part: `positions`, or one at the origin."""
        return np.zeros((1, 3)) if self.positions is None else self.positions

    @property
    def fill_value(self) -> float:
        """The value in a fill problem: `value`, or the volume in mm3."""
        return self.volume_mm3 if self.value is None else self.value
