"""The results of a run as records, from which all reports are made."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from amprep.arrays import Floats
from amprep.checks.packing.pairs import PairCounts
from amprep.checks.violation import Violation
from amprep.geometry.overhangs.regions import NOT_FACES, OverhangRegion
from amprep.geometry.removal.order import RemovalOrder
from amprep.measures.height_profile import NO_PROFILE, HeightProfile
from amprep.measures.legs import BodyLegs
from amprep.measures.printing.blade_edges import BladeEdge
from amprep.measures.printing.estimate import PrintingEstimate
from amprep.measures.removability import Removal
from amprep.model import BoundingVolume, Build, Unsupported
from amprep.model.counting import counted
from amprep.model.packing import BoundFor, Objective, PackingStep
from amprep.model.summary import Summarised
from amprep.report.triage.classes import Outcome, Triage


@dataclass(frozen=True)
class StageTime:
    """Duration of a stage, in seconds of wall-clock time."""

    name: str
    seconds: float


@dataclass(frozen=True)
class UnconnectedSquare:
    """A demand square that no support connects with the build plate.

    A demand square is the bottom of a voxel that contains an overhang and has a free voxel below it; the thesis calls
    it a red square.

    Attributes
    ----------
    part, region
        Label of the placed part, and name of the overhang.
    reason
        One of `amprep.model.supports.REASONS`.
    square
        Plane, y and x in the grid.
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
    """A region of overhangs, with its verdict and the extent to which it is supported.

    Attributes
    ----------
    name
        Name in reports, for example ``overhang 7 of bracket-2``.
    part
        Label of the placed part.
    region
        The region with the sizes that its verdict rests on.
    position_mm
        Its centre in build coordinates.
    verdict
        What it is, and whether it is supported, in words.
    triage
        What must be done about it.
    supported
        Extent to which it is supported; minor remainders count as supported.
    reasons
        Reasons for its unsupported parts, minor remainders included.
    demand_squares, connected_squares
        Number of its demand squares, and of those that a support connects.
    """

    name: str
    part: str
    region: OverhangRegion
    position_mm: tuple[float, float, float]
    verdict: str
    triage: Triage
    supported: Outcome
    reasons: tuple[str, ...] = ()
    demand_squares: int = 0
    connected_squares: int = 0


@dataclass(frozen=True)
class UnplacedRecord:
    """A copy of a part that is in no build, with the reason and its value; copies are counted from 1."""

    name: str
    copy: int
    reason: str
    value: float = 0.0


@dataclass(frozen=True, eq=False)
class ShownVolume:
    """The bounding volume of a placed part.

    Attributes
    ----------
    part
        Index of the part in its build.
    volume
        The bounding volume, which copies share.
    matrix
        ``(4, 4)``, coordinates of the volume to build coordinates.
    """

    part: int
    volume: BoundingVolume
    matrix: Floats


@dataclass(frozen=True, eq=False)
class BuildRecord:
    """A build and its figures.

    Attributes
    ----------
    file, picture, stl_files
        Names of its files, relative to the report; empty if not written.
    sha256
        SHA-256 of its build file; empty if not written.
    density, height_mm, support_volume_mm3
        See `amprep.measures.density`.
    demand_squares
        Number of demand squares, connected or not.
    unconnected
        The demand squares that are not connected.
    verification
        Broken promises; None if the build was not verified.
    pairs
        How many pairs of parts were judged by which method.
    shared_supports
        One sentence for each support that holds several parts.
    notes
        Further remarks of support planning, one sentence each.
    overhangs
        All regions of overhangs, also those that the part itself carries.
    legs, removal
        Figures of each support body; empty if not measured.
    advice
        Suggestions for a better build, one sentence each.
    volumes
        Bounding volumes that were packed; empty if nothing was packed.
    removal_order
        How the parts can be taken out of the build, by their indices in it.
    profile
        Area of the cross-section of the parts at each height.
    printing
        Mass, use of the plate, layers and hours, for the head of the report.
    blade_edges
        Of each part that has some, the longest edge that the recoater blade meets at once.
    rules
        Numbers of the ``[[rule]]`` entries that take a region of it, from 1.
    """

    build: Build
    file: str = ""
    picture: str = ""
    density: float = 0.0
    height_mm: float = 0.0
    support_volume_mm3: float = 0.0
    demand_squares: int = 0
    unconnected: tuple[UnconnectedSquare, ...] = ()
    verification: tuple[Violation, ...] | None = None
    stl_files: tuple[str, ...] = ()
    shared_supports: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    overhangs: tuple[OverhangRecord, ...] = ()
    legs: tuple[BodyLegs, ...] = ()
    advice: tuple[str, ...] = ()
    removal: tuple[Removal, ...] = ()
    volumes: tuple[ShownVolume, ...] = ()
    removal_order: RemovalOrder = field(default_factory=RemovalOrder)
    profile: HeightProfile = NO_PROFILE
    pairs: PairCounts = field(default_factory=PairCounts)
    printing: PrintingEstimate = field(default_factory=PrintingEstimate)
    blade_edges: tuple[BladeEdge, ...] = ()
    sha256: str = ""
    rules: frozenset[int] = frozenset()

    @property
    def unsupported(self) -> tuple[Unsupported, ...]:
        """The unsupported regions that are not minor."""
        return tuple(region for region in self.build.unsupported if not region.minor)

    @property
    def unsupported_mm2(self) -> float:
        """Area of the unsupported faces in mm2, without minor ones; edges and tips have no area."""
        return sum(region.measure for region in self.unsupported if region.kind not in NOT_FACES)

    @property
    def unsupported_minor_mm2(self) -> float:
        """Area of the minor unsupported faces in mm2."""
        minor = (each for each in self.build.unsupported if each.is_small and each.kind not in NOT_FACES)
        return sum(each.measure for each in minor)


@dataclass(frozen=True, eq=False, repr=False)
class RunRecord(Summarised):
    """A run of a job.

    Attributes
    ----------
    job
        Name of the job.
    version
        Version of amprep.
    status, stop_reason
        Status of the packing, and why it ended.
    found_by
        The method that found the packing, where the packer has several; else empty.
    reached
        Value of the objective: number of builds, value of the placed parts, or height of the packing (mm); None if
        nothing was packed.
    bound
        Bound on it: no packing has fewer builds, more value, or less height; None if not known.
    bound_for
        What `bound` applies to: packings of the bounding ``volumes``, or of the ``shapes`` of the parts.
    parts_bound
        Bound for any packing of the parts themselves; None if it is not known.
    packed_as
        What was packed: ``enclosing boxes``, ``boxes``, ``convex pieces`` or ``bounding volumes``.
    steps
        Steps of the packer, where it has several.
    excess
        For each part that was packed as convex pieces, their volume over that of the part, less 1.
    warnings, notes
        One sentence each: what needs attention; what was repaired or found in an input.
    by_default
        One sentence each: settings that no key states and that the printer determines.
    settings
        The job's settings as nested plain values.
    objective
        ``builds``, ``height`` or ``fill``; in a fill problem, unplaced copies are not faults.
    material
        Name of the material profile.
    report_files
        Names of the HTML and JSON reports, if they are written.
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
    by_default: tuple[str, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    objective: Objective = "builds"
    reached: float | None = None
    found_by: str = ""
    bound_for: BoundFor = "volumes"
    parts_bound: float | None = None
    packed_as: str = "bounding volumes"
    steps: tuple[PackingStep, ...] = ()
    excess: Mapping[str, float] = field(default_factory=dict)
    material: str = ""
    report_files: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Name, printer, counts and faults of the run in one line."""
        placed = counted(sum(len(entry.build.parts) for entry in self.builds), "part")
        counts = f"{placed} in {counted(len(self.builds), 'build')}, {len(self.unplaced)} unplaced"
        return f"{self.job} on {self.printer}: {counts}, {counted(self.faults, 'fault')}"

    @property
    def stacking(self) -> bool:
        """Whether parts may be above one another."""
        return bool(self.settings.get("packing", {}).get("stacking"))

    @property
    def faults(self) -> int:
        """Number of unplaced copies, unsupported regions, broken promises, and forbidden groups of locked parts."""
        listed = sum(len(entry.unsupported) + len(entry.verification or ()) for entry in self.builds)
        if self.settings.get("packing", {}).get("interlocking") == "forbid":
            listed += sum(len(entry.removal_order.locked) for entry in self.builds)
        return listed + (0 if self.objective == "fill" else len(self.unplaced))
