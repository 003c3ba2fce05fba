"""``amprep schema``: the JSON schema of job files, for editors."""

import json
from pathlib import Path
from typing import Annotated

import typer


def schema(
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="File to write; default: standard output."),
    ] = None,
) -> None:
    """Print the JSON schema of job files, by which editors complete and check keys.

    Name it in the first line of a job file, for example
    '#:schema amprep.schema.json', as the TOML extensions of most editors read it.
    """
    from amprep.files import replacing
    from amprep.job.reference.schema import job_schema

    text = json.dumps(job_schema(), indent=2, ensure_ascii=False)
    if output is None:
        typer.echo(text)
        return
    with replacing(output) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")
    typer.echo(f"wrote {output}")
