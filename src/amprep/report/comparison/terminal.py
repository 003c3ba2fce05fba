"""The table of runs side by side in the terminal."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from amprep.report.comparison.read import ComparedRun
from amprep.report.comparison.rows import ComparedFinding, figures_of, findings_in_some

if TYPE_CHECKING:
    from rich.console import RenderableType

MOST_FINDINGS = 8
"""Findings that the terminal lists."""


def summary(runs: Sequence[ComparedRun]) -> "RenderableType":
    """Return the table of figures, the best of each row in bold, and what must be fixed more often in some runs."""
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    listed = Table("")
    for run in runs:
        listed.add_column(Text(run.name), justify="right")
    for figure in figures_of(runs):
        cells = zip(figure.words(), figure.best, strict=True)
        listed.add_row(figure.title, *(Text(words, "bold" if best else "") for words, best in cells))
    found = findings_in_some(runs)
    lines = [Text(_words(each, runs)) for each in found[:MOST_FINDINGS]]
    if len(found) > MOST_FINDINGS:
        lines.append(Text(f"... and {len(found) - MOST_FINDINGS} more"))
    return Group(listed, *lines)


def _words(finding: ComparedFinding, runs: Sequence[ComparedRun]) -> str:
    counts = zip(runs, finding.runs, strict=True)
    names = ", ".join(run.name for run, count in counts if count == max(finding.runs))
    return f"must fix more often in {names}: {finding.part}: {finding.message}"


def to_json(runs: Sequence[ComparedRun]) -> dict[str, Any]:
    """Return the comparison as plain values."""
    return {
        "runs": [run.name for run in runs],
        "figures": [
            {
                "title": each.title,
                "unit": each.unit,
                "values": list(each.values),
                "better": each.better or None,
            }
            for each in figures_of(runs)
        ],
        "must_fix_in_some": [each._asdict() for each in findings_in_some(runs)],
    }
