"""The result of an inspection for the terminal."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from amprep.model.counting import counted
from amprep.report.inspection.compare import compare_makers
from amprep.report.inspection.record import InspectedPart, InspectedVolume, InspectionRecord, fit_words
from amprep.report.inspection.words import (
    contents_words,
    file_words,
    gap_words,
    overhang_words,
    printer_words,
    ratio_words,
    shape_words,
    wall_words,
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

    blocks: list[RenderableType] = [
        Text(printable(file_words(file)), style="red" if file.problem else "dim") for file in record.files
    ]
    for each in record.parts:
        blocks += _part(each)
    blocks += [Text(f"! {printable(line)}", style="yellow") for line in record.warnings]
    if len(record.parts) > 1 and any(each.volumes for each in record.parts):
        blocks.append(_makers(record))
    blocks += [Text(printable(line), style="dim") for line in _written(record, folder)]
    return Group(*blocks)


def _written(record: InspectionRecord, folder: Path) -> list[str]:
    pictures = [name for name in record.report_files if name.endswith(".png")]
    lines = [f"wrote {folder / name}" for name in record.report_files if name not in pictures]
    return [*lines, *([f"wrote {counted(len(pictures), 'picture')} in {folder}"] if pictures else [])]


def _makers(record: InspectionRecord) -> "Table":
    """Return a table of the makers over all parts."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    title = Text(f"ratios and mean seconds over {counted(len(record.parts), 'part')}")
    table = Table(box=box.SIMPLE_HEAD, padding=0, title=title, title_justify="left")
    table.add_column("volume maker", overflow="fold")
    for heading in ("mean", "greatest", "seconds", "outside", "not made"):
        table.add_column(heading, justify="right", no_wrap=True)
    for each in compare_makers(record):
        ratios = ("-", "-") if each.ratio is None else (f"{each.ratio:.3f}", f"{each.greatest_ratio:.3f}")
        table.add_row(
            Text(each.makers), *ratios, f"{each.seconds:.3f}", str(each.outside), str(each.not_made)
        )
    return table


def _part(each: InspectedPart) -> "Iterator[RenderableType]":
    from rich.text import Text

    verdict = counted(len(each.problems), "problem") if each.problems else "nothing wrong"
    yield Text.assemble(
        "\n", (printable(each.name), "bold"), ": ", (verdict, "red" if each.problems else "green")
    )
    for problem in each.problems:
        yield Text(f"  ! {printable(problem)}", style="red")
    yield from (Text(f"  - {printable(finding)}", style="yellow") for finding in each.findings)
    if each.contents is not None:
        yield _figures(each)
    if each.volumes:
        yield _volumes(each)
        for volume in each.volumes:
            for line in (*(found.message for found in volume.violations), *filter(None, [volume.failure])):
                yield Text(printable(f"  ! {volume.makers}: {line}"), style=_verdict(volume)[1])


def _figures(each: InspectedPart) -> "Table":
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, show_header=False, padding=(0, 2, 0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column()
    rows = [] if each.contents is None else list(contents_words(each.part, each.contents))
    rows += wall_words(each.walls)
    if each.overhangs is not None:
        rows += [(f"{name}", words) for name, words in overhang_words(each.overhangs)]
        rows.append(("overhang angle", f"{each.overhangs.angle_deg:g}°, the part as it lies"))
    rows += printer_words(each, _MOST_PRINTERS)
    rows += [("to fit", fit_words(each.printers))] if each.printers else []
    for name, words in rows:
        table.add_row(name, Text(printable(words)))
    return table


def _volumes(each: InspectedPart) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=0)
    table.add_column("volume maker", overflow="fold")
    for heading in ("ratio", "shape", "triangles", "seconds", "gap"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("judge", no_wrap=True)
    for volume in each.volumes:
        word, style = _verdict(volume)
        table.add_row(Text(volume.makers), *_row(volume), Text(word, style=style))
    return table


def _verdict(volume: InspectedVolume) -> tuple[str, str]:
    """Return the verdict of the judge in one word, and its style."""
    if volume.made is None:
        return "not made", "yellow"
    return ("outside", "red") if volume.violations else ("inside", "")


def _row(volume: InspectedVolume) -> tuple[str, ...]:
    if volume.made is None:
        return ("",) * 5
    shape = shape_words(volume)
    return (ratio_words(volume), shape, str(volume.triangles), f"{volume.seconds:.3f}", gap_words(volume))
