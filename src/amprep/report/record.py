"""What a run came to: the records that every report is made of."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from amprep.checks.violation import Violation
from amprep.measures.removability import Removal
from amprep.measures.slenderness import Slenderness
from amprep.model import Build, Unsupported


@dataclass(frozen=True)
class StageTime:
    """How long a stage took, in seconds of wall clock."""

    name: str
    seconds: float


@dataclass(frozen=True)
class UnconnectedRecord:
    """A red square without a way to the plate.

    Attributes
    ----------
    part, region
        For people: the placed part's label, the overhang's.
    reason
        One of `amprep.model.supports.REASONS`.
    square
        Plane, y, x in the support grid.
    position_mm
        Centre of the square in build coordinates.
    """

    part: str
    region: str
    reason: str
    square: tuple[int, int, int]
    position_mm: tuple[float, float, float]


@dataclass(frozen=True)
class OverhangRecord:
    """An overhang region: what needs support, and what became of it.

    Attributes
    ----------
    name
        For people, ``overhang 7 of bracket-2``.
    kind
        ``face``, ``edge`` or ``tip``.
    measure
        Area in mm2, length in mm, or a tip's height above the plate in mm.
    position_mm
        Its centre in build coordinates.
    red, connected
        Its red squares, and those with a way to where supports end.
    held
        ``whole`` (minor remainders aside), ``part`` or ``not``.
    reasons
        Why something of it is unsupported, minor remainders included.
    """

    name: str
    part: str
    kind: str
    measure: float
    position_mm: tuple[float, float, float]
    red: int
    connected: int
    held: str
    reasons: tuple[str, ...] = ()


@dataclass(frozen=True)
class UnplacedRecord:
    """A copy of a part that is in no build, and why; copies count from 1."""

    name: str
    copy: int
    reason: str


@dataclass(frozen=True, eq=False)
class BuildRecord:
    """One build and what was measured on it.

    Attributes
    ----------
    file, picture, stl_files
        Names of the files written for it, relative to the report; empty when not written.
    density, height_mm, support_volume_mm3
        As `amprep.measures.density` defines them.
    support_material
        What the supports are made of in words: cell, wall, and the like; shown as it is.
    red
        Number of red squares, connected or not.
    verification
        What `amprep verify` found; None when the build was not verified.
    shared
        Supports that hold several parts, one sentence each.
    notes
        What else the supports' planning has to say, one sentence each.
    overhangs
        Everything that needs support.
    advice
        What to try for a better build, one sentence each.
    columns
        How slender each of the build's support bodies is.
    removal
        What each of them costs and how it comes off.
    """

    build: Build
    file: str = ""
    picture: str = ""
    density: float = 0.0
    height_mm: float = 0.0
    support_volume_mm3: float = 0.0
    support_material: str = ""
    red: int = 0
    unconnected: tuple[UnconnectedRecord, ...] = ()
    verification: tuple[Violation, ...] | None = None
    stl_files: tuple[str, ...] = ()
    shared: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    overhangs: tuple[OverhangRecord, ...] = ()
    columns: tuple[Slenderness, ...] = ()
    advice: tuple[str, ...] = ()
    removal: tuple[Removal, ...] = ()

    @property
    def unsupported(self) -> tuple[Unsupported, ...]:
        """What is listed as unsupported and not minor."""
        return tuple(region for region in self.build.unsupported if not region.minor)

    @property
    def unsupported_mm2(self) -> float:
        """Area of the faces listed as unsupported, mm2, minor ones left out; edges and tips have none."""
        return sum(region.measure for region in self.unsupported if region.kind == "face")

    @property
    def minor_mm2(self) -> float:
        """Area of the minor faces listed as unsupported, mm2."""
        return sum(each.measure for each in self.build.unsupported if each.minor and each.kind == "face")


@dataclass(frozen=True, eq=False)
class RunRecord:
    """One run of a job.

    Attributes
    ----------
    job
        The job's name.
    version
        amprep's.
    bound
        What the packing objective cannot beat, or None.
    settings
        The job's settings as nested plain values, shown and kept as they are.
    objective
        ``builds``, ``height`` or ``fill``; in a fill problem unplaced copies are the answer, not a fault.
    """

    job: str
    version: str
    seed: int
    printer: str
    target: str
    builds: tuple[BuildRecord, ...] = ()
    unplaced: tuple[UnplacedRecord, ...] = ()
    stages: tuple[StageTime, ...] = ()
    status: str = "feasible"
    stop_reason: str = "finished"
    bound: float | None = None
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    objective: str = "builds"

    @property
    def faults(self) -> int:
        """How many things a person should look at: copies missing, regions unsupported, promises broken."""
        listed = sum(len(entry.unsupported) + len(entry.verification or ()) for entry in self.builds)
        return listed + (0 if self.objective == "fill" else len(self.unplaced))
