"""The result of a search for orientations for the terminal."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from amprep.model.orientation import OrientationProposal
from amprep.report.orientation.record import OrientationRecord, OrientedPart
from amprep.report.terminal import printable

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

HEADINGS = (
    "tilt °",
    "overhang mm²",
    "shadow cm³",
    "support cm³",
    "height mm",
    "box cm³",
    "on plate mm²",
    "tips at °",
)
"""Figures of each row, with their units."""


def summary(record: OrientationRecord, folder: Path = Path()) -> "RenderableType":
    """Return a table of proposals for each part, ready to print; `folder` is where the files were written."""
    from rich.console import Group
    from rich.text import Text

    blocks: list[RenderableType] = [
        Text(
            f"{record.printer}, {record.material}, {record.lift_mm:g} mm above the plate",
            style="dim",
        )
    ]
    for each in record.parts:
        blocks.append(Text.assemble("\n", (printable(each.name), "bold"), f": {each.tried} directions tried"))
        blocks.append(_table(each))
    blocks += [Text(f"! {printable(line)}", style="yellow") for line in record.warnings]
    blocks += [Text(printable(f"wrote {folder / name}"), style="dim") for name in record.report_files]
    return Group(*blocks)


def _table(each: OrientedPart) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=0)
    table.add_column("")
    for heading in HEADINGS:
        words, _, unit = heading.rpartition(" ")
        table.add_column(f"{words}\n{unit}", justify="right", no_wrap=True)
    table.add_column("best by", overflow="fold", min_width=9)
    for name, proposal in rows(each):
        style = "dim" if name == "drawn" else ""
        table.add_row(name, *cells(proposal), Text(", ".join(proposal.merits)), style=style)
    return table


def rows(each: OrientedPart) -> Iterator[tuple[str, OrientationProposal]]:
    """Yield name and proposal of each row of the table: the proposals by number, then the part as drawn."""
    for number, proposal in enumerate(each.proposals, start=1):
        yield str(number), proposal
    yield "drawn", each.drawn


def cells(proposal: OrientationProposal) -> tuple[str, ...]:
    """Return the figures of a proposal in words, in the order of the headings."""
    figures = proposal.figures
    support = "-" if figures.support_mm3 is None else f"{figures.support_mm3 / 1000.0:.3f}"
    if figures.unsupported:
        support += f" ({figures.unsupported} open)"
    return (
        f"{proposal.tilt_deg:.1f}",
        f"{figures.overhang_mm2:.1f}",
        f"{figures.shadow_mm3 / 1000.0:.3f}",
        support,
        f"{figures.height_mm:.1f}",
        f"{figures.box_mm3 / 1000.0:.1f}",
        f"{figures.contact_mm2:.0f}",
        f"{figures.tipping_deg:.0f}",
    )
