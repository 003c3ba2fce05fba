"""The summary of a batch: JSON for programs, a page for people."""

from collections.abc import Iterator
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

from amprep.batch.records import STATES, BatchRecord, JobOutcome
from amprep.files import replacing
from amprep.model.counting import counted
from amprep.report.json_values import write_json_file
from amprep.report.page.cells import Cell, table
from amprep.report.page.html import static_page

FORMAT = 1
"""Version of the layout; it increases when a key changes its meaning or is removed."""

JSON_FILE, PAGE_FILE = "batch.json", "batch.html"

_HEADINGS = (
    "Job",
    "State",
    "Builds|",
    "Parts|",
    "Unplaced|",
    "Must fix|",
    "Worth a check|",
    "Seconds|",
    "Message",
)


def write_summary(record: BatchRecord, output: Path) -> BatchRecord:
    """Write both files and return the record with their names; each appears complete, or not at all.

    Raises
    ------
    AmprepError
        If one cannot be written.
    """
    written = replace(record, files=(PAGE_FILE, JSON_FILE))
    with replacing(output / PAGE_FILE) as temporary:
        temporary.write_bytes(page_text(written, output).encode("utf-8", "replace"))
    write_json_file(to_json(written), output / JSON_FILE)
    return written


def to_json(record: BatchRecord) -> dict[str, Any]:
    """Return a batch as plain values."""
    return {
        "format": FORMAT,
        "amprep_version": record.version,
        "seconds": round(record.seconds, 3),
        "counts": dict(record.counts),
        "jobs": [_job_json(each) for each in record.outcomes],
        "files": list(record.files),
    }


def _job_json(outcome: JobOutcome) -> dict[str, Any]:
    return {
        "name": outcome.name,
        "source": str(outcome.source),
        "folder": str(outcome.folder),
        "state": outcome.state,
        "message": outcome.message or None,
        **outcome.figures._asdict(),
        "seconds": round(outcome.seconds, 3),
        "earlier": outcome.earlier,
        "files": list(outcome.files),
    }


def page_text(record: BatchRecord, output: Path) -> str:
    """Return the page; every string from a file is escaped.

    Parameters
    ----------
    record
        The batch.
    output
        Folder of the page, to which its links are relative.
    """
    words = ", ".join(f"{count} {state}" for state, count in record.counts.items())
    count = counted(len(record.outcomes), "job")
    rows = (tuple(_row(each, output)) for each in record.outcomes)
    body = (
        f"<header><h1>{count}</h1>\n<p class=lead>{escape(words)}; "
        f"{record.seconds:,.0f} s</p></header>\n{table(_HEADINGS, rows)}"
    )
    return static_page(f"{count} - amprep batch", body)


def _row(outcome: JobOutcome, output: Path) -> Iterator[Cell]:
    yield "name", _link(outcome, output)
    yield outcome.state + (", in an earlier batch" if outcome.earlier else "")
    yield from outcome.figures
    yield round(outcome.seconds, 1)
    yield outcome.message or ("" if outcome.state == "done" else STATES[outcome.state])


def _link(outcome: JobOutcome, output: Path) -> str:
    """Return the name of a job, as a link to its report if it has one."""
    folder = outcome.folder
    if not outcome.page or not folder.is_relative_to(output):
        return escape(outcome.name)
    path = quote((folder.relative_to(output) / outcome.page).as_posix())
    return f'<a href="{path}">{escape(outcome.name)}</a>'
