"""What a run came to: the records that every report is made of."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from amprep.checks.violation import Violation
from amprep.model import Build


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
        One of the four reasons of `amprep.model.supports`.
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
        As `amprep.report.measures` defines them.
    support_material
        What the supports are made of in words: cell, wall, and the like; shown as it is.
    red
        Number of red squares, connected or not.
    verification
        What `amprep verify` found; None when the build was not verified.
    shared
        Supports that hold several parts, one sentence each.
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

    @property
    def unsupported_mm2(self) -> float:
        """Area of the faces listed as unsupported, mm2; edges and tips have none."""
        return sum(region.measure for region in self.build.unsupported if region.kind == "face")


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
        listed = sum(len(entry.build.unsupported) + len(entry.verification or ()) for entry in self.builds)
        return listed + (0 if self.objective == "fill" else len(self.unplaced))
