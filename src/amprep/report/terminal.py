"""The closing table of a run, for the terminal."""

from collections import Counter
from typing import TYPE_CHECKING

from amprep.report.record import BuildRecord, RunRecord, StageTime

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

LISTED = 12
"""How many lines of a list the terminal shows; the reports hold all of them."""


def summary(record: RunRecord) -> "RenderableType":
    """Return the builds, what needs a look, the time per stage and the files, ready to print."""
    from rich.console import Group
    from rich.text import Text

    blocks: list[RenderableType] = [_builds(record), Text(_totals(record))]
    blocks += [Text(f"! {_shown(line)}", style="yellow") for line in _listed(_attention(record))]
    blocks += [Text(_stages(record.stages), style="dim")]
    blocks += [Text(f"wrote {_shown(name)}", style="dim") for name in _listed(_files(record))]
    return Group(*blocks)


def _builds(record: RunRecord) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(
        box=box.SIMPLE_HEAD, title=Text(_shown(f"{record.job} on {record.printer}")), title_justify="left"
    )
    table.add_column("build")
    for heading in ("parts", "density", "height", "supports", "unsupported", "verified"):
        table.add_column(heading, justify="right", no_wrap=True)
    for number, entry in enumerate(record.builds, start=1):
        table.add_row(
            str(number),
            str(len(entry.build.parts)),
            f"{100 * entry.density:.1f} %",
            f"{entry.height_mm:.1f} mm",
            f"{entry.support_volume_mm3 / 1000:.2f} cm³",
            f"{entry.unsupported_mm2:.1f} mm²",
            _verified(entry),
        )
    return table


def _verified(entry: BuildRecord) -> str:
    if entry.verification is None:
        return "-"
    return f"no ({len(entry.verification)})" if entry.verification else "yes"


def _totals(record: RunRecord) -> str:
    placed = sum(len(entry.build.parts) for entry in record.builds)
    bound = "" if record.bound is None else f", bound {record.bound:g}"
    counts = (
        f"{_count(placed, 'part')} in {_count(len(record.builds), 'build')}, {len(record.unplaced)} unplaced"
    )
    return f"{counts}; {record.status}, {record.stop_reason}{bound}; seed {record.seed}"


def _attention(record: RunRecord) -> list[str]:
    """Return a line for everything that a person should look at."""
    lines = list(record.warnings)
    lines += [f"unplaced: {item.name} (copy {item.copy}): {item.reason}" for item in record.unplaced]
    for number, entry in enumerate(record.builds, start=1):
        lines += [
            f"build {number}: {found.promise}: {found.subject}: {found.message}"
            for found in entry.verification or ()
        ]
        lines += [f"build {number}: unsupported: {words}" for words in _unsupported(entry)]
        lines += [f"build {number}: {words}" for words in _trapped(entry)]
    return lines


def _unsupported(entry: BuildRecord) -> list[str]:
    """Return one line for each part with unsupported regions."""
    lines = []
    for index, placed in enumerate(entry.build.parts):
        regions = [region for region in entry.unsupported if region.part == index]
        reasons = Counter(region.reason for region in regions)
        if len(regions) == 1:
            lines.append(f"{regions[0].label}: {regions[0].reason}")
        elif regions:
            counts = ", ".join(f"{count} {reason}" for reason, count in reasons.most_common())
            lines.append(f"{len(regions)} regions of {placed.label}: {counts}")
    return lines


def _trapped(entry: BuildRecord) -> list[str]:
    """Return a line when powder is locked in."""
    pockets = [pocket for removal in entry.removal for pocket in removal.pockets or ()]
    if not pockets:
        return []
    volume = sum(pocket.volume for pocket in pockets)
    return [
        f"powder cannot leave {_count(len(pockets), 'pocket')} in the supports, {volume:.1f} mm³ together"
    ]


def _stages(stages: tuple[StageTime, ...]) -> str:
    total = sum(stage.seconds for stage in stages)
    words = "  ".join(f"{stage.name} {stage.seconds:.1f}" for stage in stages)
    return f"{total:.1f} s: {words}" if stages else ""


def _files(record: RunRecord) -> list[str]:
    names = [name for entry in record.builds for name in (entry.file, entry.picture, *entry.stl_files)]
    return [name for name in names if name]


def _listed(lines: list[str]) -> list[str]:
    if len(lines) <= LISTED:
        return lines
    return [*lines[: LISTED - 1], f"... and {len(lines) - LISTED + 1} more, see the report"]


def _shown(text: str) -> str:
    """Return the text without characters that would steer the terminal; names come from files."""
    return "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text
    )


def _count(number: int, word: str) -> str:
    return f"{number} {word}" if number == 1 else f"{number} {word}s"
