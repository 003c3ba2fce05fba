"""Options that several benchmark commands share, and their output."""

import json
from typing import Annotated, Any, NoReturn

import typer

from amprep import cli

TimeLimit = Annotated[
    float, typer.Option("--time-limit", metavar="SECONDS", min=0.0, help="Time limit per instance.")
]
PackerName = Annotated[str, typer.Option("--packer", metavar="NAME", help="Packer to measure.")]
Seed = Annotated[int, typer.Option("--seed", metavar="N", min=0, help="Seed of the random numbers.")]
Seeds = Annotated[int, typer.Option("--seeds", metavar="N", min=1, help="Number of runs, with seeds 1 to N.")]
First = Annotated[
    int, typer.Option("--first", metavar="N", min=1, help="Number of the first instance, from 1.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the results as JSON.")]


def print_json(record: Any) -> None:
    """Print a record as indented JSON."""
    typer.echo(json.dumps(record, indent=2))


def finish(*, valid: bool) -> NoReturn:
    """End the command with exit code 0, or 1 if a result failed its independent check."""
    raise typer.Exit(cli.DONE if valid else cli.INCOMPLETE)
