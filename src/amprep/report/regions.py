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


SELF_SUPPORTING = "self-supporting"
"""What takes the regions that need no support."""


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
    centre_mm
        x, y, z of its middle.
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
    centre_mm: tuple[float, float, float]
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
        need = sum(each.rule != SELF_SUPPORTING for each in self.regions)
        return f"{self.job}: {counted(len(self.regions), 'overhang region')}, {need} not self-supporting"


def to_json(record: RegionsRecord) -> dict[str, Any]:
    """Return the regions as plain values."""
    return {"job": record.job, "regions": plain([asdict(each) for each in record.regions])}


def summary(record: RegionsRecord) -> "RenderableType":
    """Return the table of regions, ready to print: those that need support first, then the largest of the others.

    Self-supporting regions that look alike have one row.
    """
    from rich import box
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=0)
    table.add_column("region", overflow="fold")
    for heading in ("at x, y, z mm", "angle °", "area mm²"):
        table.add_column(heading, justify="right", no_wrap=True)
    for heading in ("verdict", "taken by"):
        table.add_column(heading, overflow="fold", min_width=len(f"{SELF_SUPPORTING}:"))
    several = len({each.part for each in record.regions}) > 1
    for each, count in _rows(record.regions):
        name = each.name if several else each.name.partition(" of ")[0]
        table.add_row(*(Text(printable(cell)) for cell in (name, *_cells(each, count))))
    return Group(Text(printable(str(record))), table)


def _rows(regions: Sequence[ExplainedRegion]) -> list[tuple[ExplainedRegion, int]]:
    """Return the regions in the order of the table; alike ones that need no support are one, with their number."""
    alike: dict[tuple[object, ...], list[ExplainedRegion]] = {}
    for number, each in enumerate(regions):
        key = (each.part, each.verdict, round(each.angle_deg), round(each.height_mm, 1))
        alike.setdefault(key if each.rule == SELF_SUPPORTING else (number,), []).append(each)
    groups = sorted(alike.values(), key=lambda group: _urgency(group[0]))
    return [(group[0], len(group)) for group in groups]


def _urgency(region: ExplainedRegion) -> tuple[bool, bool, float]:
    """Order what needs support before the rest, what nothing carries before the longest."""
    return region.rule == SELF_SUPPORTING, region.size_mm > 0.0, -region.size_mm


def _cells(region: ExplainedRegion, count: int) -> Sequence[str]:
    length = region.kind == "edge"
    measure = "" if region.kind == "tip" else f"{region.measure:.1f}{' mm' if length else ''}"
    rule = f"{region.rule}: {region.settings}" if region.settings else region.rule
    x, y = (round(each) for each in region.centre_mm[:2])
    return (
        f"{x}, {y}, {region.height_mm:.2f}",
        "" if region.kind == "tip" else f"{region.angle_deg:.0f}",
        measure,
        region.verdict + (f" ({count} alike)" if count > 1 else ""),
        "-" if region.rule == SELF_SUPPORTING else rule,
    )
