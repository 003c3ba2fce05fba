"""The results of inspecting parts, from which all reports about them are made."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from amprep.checks.violation import Violation
from amprep.measures.bounding_volume import count_pieces
from amprep.measures.contents import MeshContents
from amprep.measures.overhangs import OverhangFigures
from amprep.measures.printer_fit import Fit
from amprep.measures.thin_walls import ThinWall
from amprep.model import Boxes, ConvexPieces, Part, TurnedVolume
from amprep.model.counting import counted
from amprep.report.record import StageTime


@dataclass(frozen=True)
class InspectedFile:
    """A file that was read, or that cannot be read.

    Attributes
    ----------
    reader
        Name of the mesh reader.
    unit
        Unit of the coordinates in the file, or ``none``: then they are taken as millimetres.
    parts
        Number of parts in it.
    problem
        Why it cannot be read; empty if it can.
    """

    path: str
    reader: str
    size_bytes: int
    unit: str
    parts: int
    problem: str = ""


@dataclass(frozen=True)
class PrinterFit:
    """Whether a part fits the build volume of a printer, and how.

    Attributes
    ----------
    clearance_mm, lift_mm
        Distance from the walls and above the plate that the part keeps there.
    """

    printer: str
    fit: Fit
    clearance_mm: float = 0.0
    lift_mm: float = 0.0


def fit_words(fits: Sequence[PrinterFit]) -> str:
    """Return the distances that a part keeps to fit printers, in words."""

    def between(values: list[float]) -> str:
        return f"{min(values):g}" if min(values) == max(values) else f"{min(values):g} to {max(values):g}"

    clearance, lift = between([fit.clearance_mm for fit in fits]), between([fit.lift_mm for fit in fits])
    by_printer = ", by printer" if " to " in clearance + lift else ""
    return f"clearance {clearance} mm, lift {lift} mm{by_printer}"


@dataclass(frozen=True, eq=False)
class InspectedVolume:
    """A bounding volume of a part, or the reason why there is none.

    Attributes
    ----------
    makers
        Name of the volume maker, or names of a chain, joined by commas.
    made
        The bounding volume; None if the makers failed.
    volume_mm3
        Its volume, where overlaps count once.
    ratio
        Its volume over the volume of the part; None for a part that is not a solid.
    triangles
        Number of its triangles; a box has 12.
    seconds
        Processor time of the makers, without the time in which kernels are compiled.
    violations
        Findings of the judge of volume makers; empty if the volume contains the part.
    failure
        Why there is no volume; empty if there is one.
    picture
        Name of the picture; empty if not written.
    """

    makers: str
    made: TurnedVolume | None = None
    volume_mm3: float = 0.0
    ratio: float | None = None
    triangles: int = 0
    seconds: float = 0.0
    violations: tuple[Violation, ...] = ()
    failure: str = ""
    picture: str = ""

    @property
    def kind(self) -> str:
        """``boxes``, ``convex pieces`` or ``solid``; empty without a volume."""
        if self.made is None:
            return ""
        volume = self.made.volume
        if isinstance(volume, Boxes):
            return "box" if len(volume.lo) == 1 else "boxes"
        return "convex pieces" if isinstance(volume, ConvexPieces) else "solid"

    @property
    def pieces(self) -> int:
        """Number of boxes or convex pieces; 1 for a solid, 0 without a volume."""
        return 0 if self.made is None else count_pieces(self.made.volume)

    @property
    def bound_mm3(self) -> float | None:
        """Lower bound on the volume of the coverings among which the maker chose, if it proved one."""
        return None if self.made is None else self.made.bound

    @property
    def gap(self) -> float | None:
        """The gap that the maker proved, of the coverings among which it chose."""
        return None if self.made is None else self.made.gap

    @property
    def verdict(self) -> str:
        """Verdict of the judge in a few words."""
        if self.made is None:
            return "not made"
        return "contains the part" if not self.violations else "does not contain the part"


@dataclass(frozen=True, eq=False)
class InspectedPart:
    """A part with everything that was found about it.

    Attributes
    ----------
    part
        The part after repair.
    contents
        Figures of its mesh; None if the mesh cannot be used.
    problems
        What is wrong with it, one sentence each; they are faults.
    findings
        Repairs and remarks, one sentence each; they are no faults.
    overhangs
        What needs support if the part is built as it lies.
    walls
        Area of thin walls, for each thickness; empty for a surface.
    printers
        Whether it fits each printer.
    volumes
        Its bounding volumes.
    """

    part: Part
    contents: MeshContents | None = None
    problems: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()
    overhangs: OverhangFigures | None = None
    walls: tuple[ThinWall, ...] = ()
    printers: tuple[PrinterFit, ...] = ()
    volumes: tuple[InspectedVolume, ...] = ()

    @property
    def name(self) -> str:
        """Name of the part."""
        return self.part.name


@dataclass(frozen=True, eq=False)
class InspectionRecord:
    """Files and parts with everything that was found.

    Attributes
    ----------
    name
        Name of the output files.
    version
        Version of amprep.
    clearance_mm, lift_mm
        Distance from the walls and above the plate that a part keeps to fit the job's printer.
    report_files
        Names of the files that were written.
    """

    name: str
    version: str
    files: tuple[InspectedFile, ...]
    parts: tuple[InspectedPart, ...]
    clearance_mm: float = 0.0
    lift_mm: float = 0.0
    warnings: tuple[str, ...] = ()
    stages: tuple[StageTime, ...] = field(default=())
    report_files: tuple[str, ...] = ()

    @property
    def faults(self) -> int:
        """Number of files that cannot be read, of problems, and of bounding volumes that do not contain their part."""
        unread = sum(bool(file.problem) for file in self.files)
        broken = sum(bool(volume.violations) for each in self.parts for volume in each.volumes)
        return unread + broken + sum(len(each.problems) for each in self.parts)

    def __str__(self) -> str:
        """One line for each part."""
        return "\n".join(f"{each.name}: {counted(len(each.problems), 'problem')}" for each in self.parts)
