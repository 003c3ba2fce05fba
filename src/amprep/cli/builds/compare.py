"""``amprep compare``: show runs side by side."""

import json
from pathlib import Path
from typing import Annotated

import typer

from amprep import cli
from amprep.errors import JobError


def compare(
    reports: Annotated[
        list[Path],
        typer.Argument(metavar="REPORT", help="JSON reports of two runs or more (NAME.report.json)."),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE.html", help="Write a page with pictures, too."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Show runs side by side: figures, pictures, and what must be fixed.

    For example two packers: run the job with each into a folder of its own,
    and compare the two reports.

    Exit codes: 0 if done, 2 if a file is not a report of a run.
    """
    if len(reports) < 2:
        raise JobError("expected two reports or more, got one")
    from rich.console import Console

    from amprep.report.comparison.page import write_comparison
    from amprep.report.comparison.read import read_runs
    from amprep.report.comparison.terminal import summary, to_json

    runs = read_runs(reports)
    if output is not None:
        write_comparison(runs, output)
    if as_json:
        typer.echo(json.dumps(to_json(runs), indent=2))
    else:
        Console().print(summary(runs))
        if output is not None:
            typer.echo(f"wrote {output}")
    raise typer.Exit(cli.DONE)
