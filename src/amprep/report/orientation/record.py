"""The record of a search for orientations."""

from dataclasses import dataclass

from amprep.model.counting import counted
from amprep.model.orientation import OrientationProposal
from amprep.model.part import Part
from amprep.model.summary import Summarised
from amprep.report.record import StageTime


@dataclass(frozen=True, eq=False)
class OrientedPart:
    """A part with the orientations that are proposed for it.

    Attributes
    ----------
    part
        The part as drawn.
    tried
        Number of directions that were tried.
    drawn
        Its orientation as drawn, for comparison.
    proposals
        The proposals, the one with the least support first.
    """

    part: Part
    tried: int
    drawn: OrientationProposal
    proposals: tuple[OrientationProposal, ...]

    @property
    def name(self) -> str:
        """Name of the part."""
        return self.part.name


@dataclass(frozen=True, eq=False, repr=False)
class OrientationRecord(Summarised):
    """Parts with the orientations that are proposed for them.

    Attributes
    ----------
    name, version
        Name of the output files; version of amprep.
    printer, material
        Names of the printer and of the material whose limits apply.
    lift_mm
        Height of the parts above the plate.
    report_files
        Names of the files that were written.
    """

    name: str
    version: str
    printer: str
    material: str
    lift_mm: float
    parts: tuple[OrientedPart, ...]
    warnings: tuple[str, ...] = ()
    stages: tuple[StageTime, ...] = ()
    report_files: tuple[str, ...] = ()

    @property
    def faults(self) -> int:
        """0: nothing is judged."""
        return 0

    def __str__(self) -> str:
        """Summary in one line."""
        proposals = sum(len(each.proposals) for each in self.parts)
        return f"{self.name}: {counted(proposals, 'proposal')} for {counted(len(self.parts), 'part')}"
