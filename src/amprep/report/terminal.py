"""The summary of a run for the terminal."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from amprep.checks.packing.pairs import PairCounts
from amprep.model.counting import counted
from amprep.report.objective import (
    amount,
    excess_words,
    objective_words,
    part_values,
    status_words,
    step_words,
)
from amprep.report.printing import printing_words
from amprep.report.record import BuildRecord, RunRecord, StageTime
from amprep.report.removal_order import hindrances_of, waiting_parts
from amprep.report.triage.classes import CHECK, MUST_FIX
from amprep.report.triage.findings import Finding, findings_of
from amprep.report.triage.groups import FindingGroup, count_by_triage, counts_in_words, grouped
from amprep.report.triage.rules import rules_of
from amprep.report.triage.words import finding_words

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

MOST_LINES = 12
"""Lines of a list that the terminal shows; the reports contain all of them."""

MOST_FINDINGS = 6
"""Lines on what must be fixed, and on what is worth a check."""


def summary(record: RunRecord, folder: Path = Path()) -> "RenderableType":
    """Return the table of builds, the issues, the durations of stages and the files in `folder`, ready to print."""
    from rich.console import Group
    from rich.text import Text

    findings = findings_of(record)
    blocks: list[RenderableType] = [_builds(record), Text(_totals(record))]
    blocks += [Text(printable(line), style="dim") for line in (*_printing(record), *rules_of(record))]
    if record.steps:
        blocks.append(Text(printable(step_words(record)), style="dim"))
    if pieces := excess_words(record):
        blocks.append(Text(printable(pieces), style="dim"))
    blocks += [Text(printable(line), style="dim") for line in record.by_default]
    blocks += [Text(printable(line), style="dim") for line in _listed(_values(record), "in the report")]
    blocks += [Text(printable(line), style="dim") for line in _listed(_waiting(record), "in the report")]
    blocks += [
        Text(f"! {printable(line)}", style="yellow") for line in _listed(_issues(record), "in the report")
    ]
    blocks += [Text(printable(line), style=style) for line, style in _triage(findings)]
    blocks += [Text(line, style="dim") for line in _judged(record)]
    blocks += [Text(_stages(record.stages), style="dim")]
    written = [f"wrote {folder / name}" for name in _files(record)]
    blocks += [Text(printable(line), style="dim") for line in _listed(written, f"in {folder}")]
    return Group(*blocks)


def _builds(record: RunRecord) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(
        box=box.SIMPLE_HEAD, title=Text(printable(f"{record.job} on {record.printer}")), title_justify="left"
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


def _judged(record: RunRecord) -> list[str]:
    """Return a line about how the pairs of parts were judged, if any were."""
    pairs = sum((entry.pairs for entry in record.builds), PairCounts())
    return [f"distances of parts checked exactly: {pairs}"] if pairs.total else []


def _totals(record: RunRecord) -> str:
    placed = sum(len(entry.build.parts) for entry in record.builds)
    counts = f"{counted(placed, 'part')} in {counted(len(record.builds), 'build')}, {len(record.unplaced)} unplaced"
    words = objective_words(record)
    reached = f": {words}" if words else ""
    return f"{counts}; {status_words(record)}{reached}; seed {record.seed}"


def _values(record: RunRecord) -> list[str]:
    """Return one line for each part of a fill problem."""
    return [
        f"{each.name}: {each.placed} of {each.copies} placed, value {amount(each.value)} each"
        for each in part_values(record)
    ]


def _waiting(record: RunRecord) -> list[str]:
    """Return, without stacking, one line for each part that can be lifted off only after others."""
    numbered = enumerate(() if record.stacking else record.builds, start=1)
    return [f"build {number}: {line}" for number, entry in numbered for line in waiting_parts(entry)]


def _printing(record: RunRecord) -> list[str]:
    """Return a line with what the builds take, if there are builds."""
    return list(filter(None, [printing_words([entry.printing for entry in record.builds])]))


def _issues(record: RunRecord) -> list[str]:
    """Return one line for each warning, for unplaced copies of a fill job, and for parts whose removal is unknown."""
    lines = list(record.warnings)
    if record.objective == "fill":
        lost = [item for item in record.unplaced if item.reason != "no room left"]
        lines += [f"unplaced: {item.name} (copy {item.copy}): {item.reason}" for item in lost]
    for number, entry in enumerate(record.builds, start=1):
        lines += [
            f"build {number}: {line}" for line in hindrances_of(entry)[len(entry.removal_order.locked) :]
        ]
    return lines


def _triage(findings: Sequence[Finding]) -> list[tuple[str, str]]:
    """Return a line with the number of findings of each class, and the first that must be fixed, with their styles."""
    counts = count_by_triage(findings)
    if not findings:
        return []
    groups = grouped(findings)
    urgent = [each for group in groups for each in group.findings if each.triage == MUST_FIX]
    several = any(each.build > 1 for each in findings)
    must_fix = [f"must fix: {_in_build(each, several)}{finding_words(each)}" for each in urgent]
    checks = [f"worth a check: {_group_words(each, several)}" for each in groups if each.triage == CHECK]
    return [
        (counts_in_words(counts), "red" if urgent else "yellow" if checks else "green"),
        *((line, "red") for line in _listed(must_fix, "in the report", MOST_FINDINGS)),
        *((line, "yellow") for line in _listed(checks, "in the report", MOST_FINDINGS)),
    ]


def _group_words(group: FindingGroup, several: bool) -> str:
    """Return a group in one line; what was found if it is a single finding."""
    (first, *more) = group.findings
    return f"{group.part}: {group.words}" if more else f"{_in_build(first, several)}{finding_words(first)}"


def _in_build(finding: Finding, several: bool) -> str:
    return f"build {finding.build}: " if several and finding.build else ""


def _stages(stages: tuple[StageTime, ...]) -> str:
    total = sum(stage.seconds for stage in stages)
    durations = "  ".join(f"{stage.name} {stage.seconds:.1f}" for stage in stages)
    return f"{total:.1f} s: {durations}" if stages else ""


def _files(record: RunRecord) -> list[str]:
    """Return the names of all files of the run, reports first."""
    names = [name for entry in record.builds for name in (entry.file, entry.picture, *entry.stl_files)]
    return [*record.report_files, *(name for name in names if name)]


def _listed(lines: list[str], rest: str, most: int = MOST_LINES) -> list[str]:
    """Return the first lines; if there are too many, the last one says where the rest is."""
    if len(lines) <= most:
        return lines
    return [*lines[: most - 1], f"... and {len(lines) - most + 1} more {rest}"]


def printable(text: str) -> str:
    """Return the text without control characters, which names from files may contain."""
    return "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text
    )
