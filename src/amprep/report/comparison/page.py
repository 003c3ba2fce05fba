"""The page that shows runs side by side, one file that opens offline."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from amprep.files import replacing
from amprep.report.comparison.read import ComparedRun
from amprep.report.comparison.rows import figures_of, findings_in_some, must_fix_anything
from amprep.report.page.cells import Cell, table
from amprep.report.page.html import static_page

MOST_PICTURES = 12
"""Builds of each run whose pictures the page has."""

MOST_FINDINGS = 500
"""Findings that the page lists."""


def write_comparison(runs: Sequence[ComparedRun], path: Path) -> None:
    """Write the page; it appears complete, or not at all."""
    text = comparison_text(runs).encode("utf-8", "replace")
    with replacing(path) as temporary:
        temporary.write_bytes(text)


def comparison_text(runs: Sequence[ComparedRun]) -> str:
    """Return the whole page; every string from a report is escaped."""
    names = [run.name for run in runs]
    title = f"{len(runs)} runs side by side"
    body = (
        f"<header><h1>{title}</h1></header>\n{_figures(runs, names)}{_pictures(runs)}{_findings(runs, names)}"
    )
    return static_page(f"{title} - amprep", body)


def _figures(runs: Sequence[ComparedRun], names: Sequence[str]) -> str:
    rows: list[list[Cell]] = []
    for figure in figures_of(runs):
        cells = zip(figure.words(), figure.best, strict=True)
        rows.append(
            [figure.title, *(("number best" if best else "number", escape(text)) for text, best in cells)]
        )
    note = '<p class="lead">Bold: the best of the row. In brackets: the difference to the first run.</p>\n'
    return f"{note}{table(('', *(f'{name}|' for name in names)), rows)}"


def _pictures(runs: Sequence[ComparedRun]) -> str:
    count = min(max(len(run.builds) for run in runs), MOST_PICTURES)
    rows = [[_picture(run, number) for run in runs] for number in range(count)]
    if not any(text for row in rows for _, text in row):
        return ""
    return f"<h2>Builds</h2>\n{table([run.name for run in runs], rows)}"


def _picture(run: ComparedRun, number: int) -> tuple[str, str]:
    encoded = run.picture(run.builds[number]) if number < len(run.builds) else ""
    image = f'<img alt="build {number + 1} of {escape(run.name)}" src="data:image/png;base64,{encoded}">'
    return "picture", image if encoded else ""


def _findings(runs: Sequence[ComparedRun], names: Sequence[str]) -> str:
    found = findings_in_some(runs)
    if not found:
        words = (
            "What must be fixed is the same in all runs."
            if must_fix_anything(runs)
            else "Nothing must be fixed."
        )
        return f"<h2>Findings</h2>\n<p>{words}</p>\n"
    rows = [
        [each.part, each.message, *(str(count) if count else "-" for count in each.runs)]
        for each in found[:MOST_FINDINGS]
    ]
    left = len(found) - len(rows)
    note = f'<p class="empty">{left} more are in the JSON reports.</p>\n' if left else ""
    return f"<h2>Must be fixed more often in some runs</h2>\n{table(('Part', 'Finding', *names), rows)}{note}"
