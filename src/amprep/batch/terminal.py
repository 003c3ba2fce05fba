"""The summary of a batch in the terminal."""

from pathlib import Path

from rich.console import Group
from rich.markup import escape
from rich.table import Table

from amprep.batch.records import BatchRecord
from amprep.model.counting import counted

MOST_ROWS = 40
"""Jobs that the table lists; those that are not done come first."""


def summary(record: BatchRecord, folder: Path) -> Group:
    """Return the table of jobs, and the line of counts."""
    table = Table(box=None, pad_edge=False)
    table.add_column("job")
    table.add_column("state")
    for heading in ("builds", "parts", "unplaced", "must fix", "worth a check", "seconds"):
        table.add_column(heading, justify="right")
    shown = sorted(record.outcomes, key=lambda each: each.state == "done")[:MOST_ROWS]
    for each in shown:
        numbers = (*map(str, each.figures), f"{each.seconds:.1f}")
        state = f"{each.state} earlier" if each.earlier else each.state
        table.add_row(escape(each.name), state, *numbers)
    left = len(record.outcomes) - len(shown)
    lines = [f"... and {left} more in the summary"] if left else []
    counts = ", ".join(f"{count} {state}" for state, count in record.counts.items())
    lines += [f"{counted(len(record.outcomes), 'job')}: {counts or 'none'}; {record.seconds:.1f} s"]
    lines += [f"wrote {escape(str(folder / name))}" for name in record.files]
    return Group(table, "", *lines)
