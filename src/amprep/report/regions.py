"""The overhang regions of parts with their verdicts and the rules that take them, for ``amprep support --explain``."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from amprep.model.counting import counted
from amprep.model.summary import Summarised
from amprep.report.json_values import plain
from amprep.report.terminal import printable

if TYPE_CHECKING:
    from rich.console import RenderableType


@dataclass(frozen=True)
class ExplainedRegion:
    """An overhang region, before supports are planned.

    Attributes
    ----------
    name
        Name in reports, for example ``overhang 7 of bracket``.
    part
        Name of the part.
    kind
        Kind of the overhang.
    size_mm
        Length of a ledge, span of a bridge, diameter of a bore; 0 where the part does not carry it.
    angle_deg
        Smallest angle of its faces to the plate.
    height_mm
        Height of its lowest point.
    measure
        Area in mm2, length of an edge in mm, 0 for a tip.
    verdict
        The verdict in words.
    rule
        What takes it: ``[[rule]] 2``, ``default`` or ``self-supporting``.
    settings
        Settings of the rule in words; empty for others.
    """

    name: str
    part: str
    kind: str
    size_mm: float
    angle_deg: float
    height_mm: float
    measure: float
    verdict: str
    rule: str
    settings: str = ""


@dataclass(frozen=True, repr=False)
class RegionsRecord(Summarised):
    """The overhang regions of parts of a job.

    Attributes
    ----------
    job
        Name of the job.
    regions
        The regions, part by part.
    """

    job: str
    regions: tuple[ExplainedRegion, ...] = ()

    @property
    def faults(self) -> int:
        """0: nothing is judged."""
        return 0

    def __str__(self) -> str:
        """Summary in one line."""
        need = sum(each.rule != "self-supporting" for each in self.regions)
        return f"{self.job}: {counted(len(self.regions), 'overhang region')}, {need} not self-supporting"


def to_json(record: RegionsRecord) -> dict[str, Any]:
    """Return the regions as plain values."""
    return {"job": record.job, "regions": plain([asdict(each) for each in record.regions])}


def summary(record: RegionsRecord) -> "RenderableType":
    """Return the table of regions, ready to print."""
    from rich import box
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=0)
    for heading in ("region", "kind"):
        table.add_column(heading, overflow="fold")
    for heading in ("size mm", "angle °", "height mm", "area mm²"):
        table.add_column(heading, justify="right", no_wrap=True)
    for heading in ("verdict", "taken by"):
        table.add_column(heading, overflow="fold")
    several = len({each.part for each in record.regions}) > 1
    for each in record.regions:
        name = each.name if several else each.name.partition(" of ")[0]
        table.add_row(*(Text(printable(cell)) for cell in (name, *_cells(each))))
    return Group(Text(printable(str(record))), table)


def _cells(region: ExplainedRegion) -> Sequence[str]:
    length = region.kind == "edge"
    measure = "" if region.kind == "tip" else f"{region.measure:.1f}{' mm' if length else ''}"
    rule = f"{region.rule}: {region.settings}" if region.settings else region.rule
    return (
        region.kind,
        f"{region.size_mm:.1f}" if region.size_mm else "",
        "" if region.kind == "tip" else f"{region.angle_deg:.0f}",
        f"{region.height_mm:.2f}",
        measure,
        region.verdict,
        rule,
    )
