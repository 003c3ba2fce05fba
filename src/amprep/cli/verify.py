"""``amprep verify``: verify a build from its file alone."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep import cli

if TYPE_CHECKING:
    from amprep.checks.violation import Violation


def verify(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Build file that amprep wrote (.3mf, any target).")
    ],
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print nothing; the exit code tells the result.")
    ] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Verify a build from its file alone.

    It checks that parts are inside the build volume, keep their clearance and
    are unchanged; that supports are closed, stand on the plate and do not
    penetrate parts; that they keep the limits of the build on walls, legs and
    territory; and that every overhang is supported, or listed with a reason.

    Exit codes: 0 if every promise holds, 1 if one is broken, 2 if the file is
    not a build that amprep wrote.
    """
    from amprep import api

    result = api.verify(file)
    violations = result.violations
    if as_json:
        from amprep.report.json_values import violations_json

        record = {"file": str(file), "ok": result.ok, "violations": violations_json(violations)}
        judged = {"pairs_judged": asdict(result.pairs), "limits_judged": result.extent}
        typer.echo(json.dumps(record | judged, indent=2))
    elif not quiet:
        _show(file, violations, result.extent)
        if result.pairs.total:
            typer.echo(f"distances of parts checked exactly: {result.pairs}")
    raise typer.Exit(cli.INCOMPLETE if violations else cli.DONE)


def _show(file: Path, violations: "tuple[Violation, ...]", extent: dict[str, str]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from amprep.checks.supports.limits import NOT_JUDGED
    from amprep.pipeline.verify import PROMISES

    broken = {violation.promise for violation in violations}
    table = Table("promise", "", "subject", "finding", title=escape(file.name), title_justify="left")
    for promise in PROMISES:
        if promise not in broken:
            text = extent.get(promise, "")
            is_judged = not text.startswith(NOT_JUDGED)
            table.add_row(promise, "[green]holds" if is_judged else "-", "", text)
    for violation in violations:
        table.add_row(violation.promise, "[red]broken", escape(violation.subject), escape(violation.message))
    Console().print(table)
