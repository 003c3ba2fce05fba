"""The result of an inspection for the terminal."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from amprep.report.counting import counted
from amprep.report.inspection.record import InspectedPart, InspectedVolume, InspectionRecord
from amprep.report.inspection.words import (
    contents_words,
    file_words,
    gap_words,
    overhang_words,
    printer_words,
    ratio_words,
)
from amprep.report.terminal import printable

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

_MOST_PRINTERS = 6
"""Number of printers that the terminal names for each way to fit; the reports name all."""


def summary(record: InspectionRecord, folder: Path = Path()) -> "RenderableType":
    """Return files, parts and bounding volumes, ready to print; `folder` is where the files were written."""
    from rich.console import Group
    from rich.text import Text

    blocks: list[RenderableType] = [Text(printable(file_words(file)), style="dim") for file in record.files]
    for each in record.parts:
        blocks += _part(each, record)
    blocks += [Text(f"! {printable(line)}", style="yellow") for line in record.warnings]
    blocks += [Text(printable(f"wrote {folder / name}"), style="dim") for name in record.report_files]
    return Group(*blocks)


def _part(each: InspectedPart, record: InspectionRecord) -> "Iterator[RenderableType]":
    from rich.text import Text

    verdict = counted(len(each.problems), "problem") if each.problems else "nothing wrong"
    yield Text.assemble(
        "\n", (printable(each.name), "bold"), ": ", (verdict, "red" if each.problems else "green")
    )
    for problem in each.problems:
        yield Text(f"  ! {printable(problem)}", style="red")
    yield from (Text(f"  - {printable(finding)}", style="yellow") for finding in each.findings)
    if each.contents is not None:
        yield _figures(each, record)
    if each.volumes:
        yield _volumes(each)


def _figures(each: InspectedPart, record: InspectionRecord) -> "Table":
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, show_header=False, padding=(0, 2, 0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column()
    rows = [] if each.contents is None else list(contents_words(each.part, each.contents))
    if each.overhangs is not None:
        rows += [(f"{name}", words) for name, words in overhang_words(each.overhangs)]
        rows.append(("overhang angle", f"{each.overhangs.angle_deg:g}°, the part as it lies"))
    rows += printer_words(each, _MOST_PRINTERS)
    rows.append(("to fit", f"clearance {record.clearance_mm:g} mm, lift {record.lift_mm:g} mm"))
    for name, words in rows:
        table.add_row(name, Text(printable(words)))
    return table


def _volumes(each: InspectedPart) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.add_column("volume maker", no_wrap=True)
    for heading in ("ratio", "kind", "pieces", "triangles", "seconds", "gap"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("part is")
    for volume in each.volumes:
        style = "red" if volume.violations else ("yellow" if volume.made is None else "")
        verdict = "; ".join(found.message for found in volume.violations) or volume.failure or "inside"
        table.add_row(Text(volume.makers), *_row(volume), Text(printable(verdict), style=style))
    return table


def _row(volume: InspectedVolume) -> tuple[str, ...]:
    if volume.made is None:
        return ("",) * 6
    counts = (str(volume.pieces), str(volume.triangles))
    return (ratio_words(volume), volume.kind, *counts, f"{volume.seconds:.3f}", gap_words(volume))
