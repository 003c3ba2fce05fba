"""``amprep verify``: re-check a written build from the file alone."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep import cli

if TYPE_CHECKING:
    from amprep.checks.violation import Violation


def verify(
    file: Annotated[Path, typer.Argument(help="A build job that amprep wrote (.3mf, any target).")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing; the exit code tells.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show tracebacks.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Re-check a written build from the file alone.

    Judges that parts lie in the build volume, keep their clearance and are unchanged, that supports are closed,
    stand on the plate and do not cut into parts, and that every overhang is held or listed with a reason.
    Exit code 0: every promise holds; 1: some do not; 2: not a build of amprep's.
    """
    from amprep.pipeline.verify import verify_file

    violations = verify_file(file)
    if as_json:
        rows = [{"promise": v.promise, "subject": v.subject, "message": v.message} for v in violations]
        typer.echo(json.dumps({"file": str(file), "ok": not violations, "violations": rows}, indent=2))
    elif not quiet:
        _show(file, violations)
    raise typer.Exit(cli.INCOMPLETE if violations else cli.DONE)


def _show(file: Path, violations: "tuple[Violation, ...]") -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from amprep.pipeline.verify import PROMISES

    broken = {violation.promise for violation in violations}
    table = Table("promise", "", "subject", "found", title=escape(file.name), title_justify="left")
    for promise in PROMISES:
        if promise not in broken:
            table.add_row(promise, "[green]holds")
    for violation in violations:
        table.add_row(violation.promise, "[red]broken", escape(violation.subject), escape(violation.message))
    Console().print(table)
