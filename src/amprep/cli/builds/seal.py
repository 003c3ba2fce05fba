"""``amprep seal``: seal files."""

import json
from pathlib import Path
from typing import Annotated

import typer


def seal(
    files: Annotated[list[Path], typer.Argument(metavar="FILE", help="Build files, or any other files.")],
    key: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Key of seals: a file with a secret of 16 bytes or more, or an Ed25519 key (PEM).",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Write a seal beside each file, which 'amprep verify --key' checks.

    With a key, a seal shows that the file is as its owner sealed it. Without
    one, it shows accidental changes only.

    Exit codes: 0 if done, 2 if a file or the key cannot be read.
    """
    from amprep.sealing.seal import seal_file

    sealed = [seal_file(file, key) for file in files]
    if as_json:
        typer.echo(json.dumps([{"seal": str(path), "method": method} for path, method in sealed], indent=2))
    else:
        for path, method in sealed:
            typer.echo(f"wrote {path} ({method})")
