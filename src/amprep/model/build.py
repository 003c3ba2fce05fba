"""One finished build, as a build file records it and `amprep verify` reads it back."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from amprep.arrays import Floats, Ints, frozen
from amprep.model.build_volume import BuildVolume
from amprep.model.mesh import Mesh
from amprep.model.part import Orientations, Part
from amprep.model.supports import EXCEPTED
from amprep.model.supports.rules import SupportRules
from amprep.model.supports.sizes import SupportSizes

Target = Literal["generic", "prusaslicer", "cura"]
SupportsAs = Literal["support", "model"]
TARGETS: tuple[Target, ...] = ("generic", "prusaslicer", "cura")


@dataclass(frozen=True, eq=False)
class BuildSettings:
    """The rules of a build; its file records them, so that the build can be judged from the file alone.

    Attributes
    ----------
    build_id
        Name of the job and number of the build, for example ``bracket.build-1``.
    space
        The build volume.
    target
        Program that will open the build file.
    printer
        Name of the printer.
    clearance, lift
        Smallest distance between parts, and height of the lowest parts above the plate, mm.
    overlap
        Depth to which connectors enter the parts, mm.
    reach
        Largest distance of a supported overhang from a contact, mm, for bodies that state none.
    rules
        Rules for the supports; a part's own overhang angle is recorded with the part.
    supported
        False when the job asked for no supports.
    supports_as
        Type that a generic file gives to solid supports.
    sizes
        Sizes of supports that judges need, for bodies that state none.
    plate_origin
        Corner of the plate, x and y in mm, in the coordinates in which the target of the file places objects.
    planning
        Further settings by which the supports were planned, with the keys of a job file; no judge reads them. Empty
        where they are unknown, as in files of earlier versions.
    """

    build_id: str
    space: BuildVolume
    target: Target = "generic"
    printer: str = ""
    clearance: float = 0.0
    lift: float = 0.0
    overlap: float = 0.1
    reach: float = 1.5
    rules: SupportRules = field(default_factory=SupportRules)
    supported: bool = True
    supports_as: SupportsAs = "support"
    sizes: SupportSizes = field(default_factory=SupportSizes)
    plate_origin: tuple[float, float] = (0.0, 0.0)
    planning: Mapping[str, Any] = field(default_factory=dict)

    def reach_of(self, body: "SupportBody") -> float:
        """Return the largest distance (mm) of a supported overhang from a contact of a body."""
        return self.reach if body.reach is None else body.reach

    def sizes_of(self, body: "SupportBody") -> SupportSizes:
        """Return the sizes that a body is judged by."""
        return self.sizes if body.sizes is None else body.sizes


@dataclass(frozen=True, eq=False)
class PlacedPart:
    """A part at its position in a build.

    Attributes
    ----------
    label
        Unique name in the build: the part's name, with ``-2`` and so on for further copies.
    matrix
        ``(4, 4)`` part coordinates to build coordinates.
    recorded_digest
        `Mesh.digest` that the build file records for this part; empty before the file is written.
    moved_mm
        Distance (mm) from the position that the build file records.
    """

    label: str
    part: Part
    matrix: Floats
    orientations: Orientations = field(default_factory=Orientations)
    recorded_digest: str = ""
    moved_mm: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "matrix", frozen(self.matrix, np.float64).reshape(4, 4))

    @property
    def mesh(self) -> Mesh:
        """The mesh in build coordinates."""
        return self.part.mesh.moved(self.matrix)


@dataclass(frozen=True, eq=False)
class Lattice:
    """Round beams with balls at their ends, and the solids that they carry.

    Attributes
    ----------
    nodes, struts, radii
        ``(n, 3)`` mm, ``(m, 2)`` int32, and ``(m, 2)`` mm at both ends.
    solids
        Everything that is no beam, for example connectors; may have no triangles.
    stand_in
        Mesh for programs that cannot read beams: the whole body as a solid, or a coarser one.
    room
        ``(2, 3)`` mm, corners of the box to which beams are clipped; None for no clipping.
    """

    nodes: Floats
    struts: Ints
    radii: Floats
    solids: Mesh
    stand_in: Mesh
    room: Floats | None

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", frozen(self.nodes, np.float64, 3))
        object.__setattr__(self, "struts", frozen(self.struts, np.int32, 2))
        object.__setattr__(self, "radii", frozen(self.radii, np.float64, 2))
        if self.room is not None:
            object.__setattr__(self, "room", frozen(self.room, np.float64, 3))

    @cached_property
    def digest(self) -> str:
        """SHA-256 of beams, meshes and box as 3MF files store them: float32 after rounding to the digits written."""
        sizes, which = np.unique(self.radii, return_inverse=True)
        radii = np.array([float(f"{size:.9g}") for size in sizes.tolist()])[which]
        coordinates = [self.nodes[self.struts], self.solids.vertices[self.solids.triangles]]
        coordinates += [] if self.room is None else [self.room]
        parts = [np.round(each, 6).astype("<f4") + np.float32(0.0) for each in coordinates]
        counts = np.array([len(each) for each in parts], "<i8")
        arrays = [counts, *parts, radii.astype("<f4")]
        data = b"".join(each.tobytes() for each in arrays)
        return hashlib.sha256(data + self.stand_in.digest.encode()).hexdigest()


@dataclass(frozen=True)
class StoredSupport:
    """What a build file records of a support, and what is in the file.

    Attributes
    ----------
    recorded_digest
        SHA-256 of the geometry that the file records; empty in files of earlier versions.
    digest
        SHA-256 of the geometry in the file.
    moved_mm
        Distance (mm) from where the support was written.
    """

    recorded_digest: str
    digest: str
    moved_mm: float


@dataclass(frozen=True, eq=False)
class SupportBody:
    """Finished support geometry of one group, in build coordinates.

    Attributes
    ----------
    mesh
        The whole body; beams are prisms in it.
    parts
        Indices of the placed parts that it supports; more than one only where parts share supports.
    surface
        True for walls without thickness, which the machine must not fill.
    lattice
        The body as beams, for a file with beams; None for a mesh.
    reach, sizes
        Reach (mm) and sizes of the supports of ``[[rule]]`` entries; None for those of the settings of the build.
    stored
        What its file says of it; None for a support that is in no file.
    """

    name: str
    mesh: Mesh
    parts: tuple[int, ...]
    surface: bool = False
    lattice: Lattice | None = None
    reach: float | None = None
    sizes: SupportSizes | None = None
    stored: StoredSupport | None = None

    @property
    def digest(self) -> str:
        """SHA-256 of its geometry as 3MF files store it."""
        return self.mesh.digest if self.lattice is None else self.lattice.digest


@dataclass(frozen=True, eq=False)
class Unsupported:
    """An overhang without a contact within reach.

    Attributes
    ----------
    part
        Index of the placed part.
    label
        Name in reports, for example ``overhang 7 of bracket-2``.
    kind
        ``face``, ``edge`` or ``tip``.
    reason
        One of `amprep.model.supports.REASONS`.
    measure
        Unsupported area in mm2, length in mm, or 0 for a tip.
    points
        ``(n, 3)`` mm, build coordinates; every point of the region is within `radius` of one of them.
    radius
        mm.
    minor
        True if listed but not counted as a fault: below the smallest area or length and adjacent to supported
        surface, or excepted by a rule of the job.
    """

    part: int
    label: str
    kind: str
    reason: str
    measure: float
    points: Floats
    radius: float
    minor: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen(self.points, np.float64, 3))

    @property
    def is_small(self) -> bool:
        """Whether it is minor because of its size."""
        return self.minor and self.reason != EXCEPTED


@dataclass(frozen=True)
class StoredRecord:
    """The digest that a build file states of amprep's record in it, and that of the record as it is.

    Attributes
    ----------
    recorded_digest
        SHA-256 that the file states; empty in files of earlier versions.
    digest
        SHA-256 of the settings, parts, supports and listed overhangs as the file states them.
    """

    recorded_digest: str
    digest: str


@dataclass(frozen=True, eq=False)
class Build:
    """One printing run: its settings, parts, supports, and unsupported overhangs; `stored` is that of its file."""

    settings: BuildSettings
    parts: tuple[PlacedPart, ...]
    supports: tuple[SupportBody, ...] = ()
    unsupported: tuple[Unsupported, ...] = ()
    stored: StoredRecord | None = None


MAX_STAND_IN_TRIANGLES = 100_000
"""Largest number of triangles of a mesh for programs that cannot read beams; larger bodies get a coarser mesh."""
