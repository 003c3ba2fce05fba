"""``amprep verify``: verify builds from their files."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from amprep import cli, workers
from amprep.cli.options import Workers

if TYPE_CHECKING:
    from amprep.pipeline.verifying.build import Verification

_AGAINST = "What the builds are verified against"


def verify(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE", help="Build files that amprep wrote (.3mf, any target)."),
    ],
    job: Annotated[
        Path | None,
        typer.Option(metavar="JOB.toml", help="The job that ordered the builds.", rich_help_panel=_AGAINST),
    ] = None,
    printer: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Printer by name or profile file; see 'amprep printers list'.",
            rich_help_panel=_AGAINST,
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="The JSON report of their run, with their SHA-256.", rich_help_panel=_AGAINST
        ),
    ] = None,
    key: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Key of seals: a file with a secret of 16 bytes or more, or an Ed25519 key (PEM).",
            rich_help_panel=_AGAINST,
        ),
    ] = None,
    removability: Annotated[
        bool, typer.Option("--removability", help="Judge trapped powder and access to contacts, too (slow).")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print nothing; the exit code tells the result.")
    ] = False,
    count: Workers = None,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Verify builds from their files, and against what was ordered.

    It checks that parts are inside the build volume, keep their clearance and
    are unchanged; that supports are closed, stand on the plate and do not
    penetrate parts; that they keep the limits of the build on walls, legs and
    territory; and that every overhang is supported, or listed with a reason.

    The settings are those that the file states; those that are weaker than
    usual are printed. With --job, the settings and parts of the job count
    instead, and with --printer the build volume of the printer.

    Exit codes: 0 if every promise holds, 1 if one is broken, 2 if a file is
    not a build that amprep wrote.
    """
    from amprep import api

    with workers.allowed(count or workers.available()):
        results = {
            file: api.verify(
                file, job=job, printer=printer, report=report, key=key, removability=removability
            )
            for file in files
        }
    if as_json:
        records = [_json(file, result) for file, result in results.items()]
        typer.echo(json.dumps(records[0] if len(records) == 1 else records, indent=2))
    elif not quiet:
        for file, result in results.items():
            _show(file, result)
    raise typer.Exit(cli.DONE if all(result.ok for result in results.values()) else cli.INCOMPLETE)


def _json(file: Path, result: "Verification") -> dict[str, Any]:
    from amprep.report.json_values import violations_json

    return {
        "file": str(file),
        "ok": result.ok,
        "violations": violations_json(result.violations),
        "pairs_judged": asdict(result.pairs),
        "limits_judged": result.extent,
        "weaker_settings": list(result.weaker),
    }


def _show(file: Path, result: "Verification") -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from amprep.checks.supports.limits import NOT_JUDGED
    from amprep.pipeline.verifying.build import PROMISES

    broken = {violation.promise for violation in result.violations}
    table = Table("promise", "", "subject", "finding", title=escape(file.name), title_justify="left")
    for promise in dict.fromkeys((*PROMISES, *result.extent)):
        if promise not in broken:
            text = result.extent.get(promise, "")
            is_judged = not text.startswith(NOT_JUDGED)
            table.add_row(promise, "[green]holds" if is_judged else "-", "", escape(text))
    for violation in result.violations:
        table.add_row(violation.promise, "[red]broken", escape(violation.subject), escape(violation.message))
    console = Console()
    console.print(table)
    for words in result.weaker:
        console.print(f"weaker than usual, as the file states: {words}", markup=False, highlight=False)
