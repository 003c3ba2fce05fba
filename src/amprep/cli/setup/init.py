"""``amprep init``: write a job file with every key and its meaning."""

import os
import tomllib
from pathlib import Path
from typing import Annotated

import typer

from amprep.cli.completion import cells, materials, packers, printers
from amprep.cli.options import Force


def init(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="INPUT...",
            help="Files and folders of the job; NAME:4 prints four copies.",
            show_default=False,
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="The job file.")] = Path("job.toml"),
    printer: Annotated[
        str | None,
        typer.Option(
            help="Printer by name or profile file; see 'amprep printers list'.", autocompletion=printers
        ),
    ] = None,
    material: Annotated[
        str | None,
        typer.Option(
            help="Material by name or profile file; see 'amprep materials list'.", autocompletion=materials
        ),
    ] = None,
    packer: Annotated[
        str | None, typer.Option(help="Packer by name; see 'amprep plugins list'.", autocompletion=packers)
    ] = None,
    cell: Annotated[
        str | None,
        typer.Option(help="Lattice cell by name, or a file that declares one.", autocompletion=cells),
    ] = None,
    target: Annotated[
        str | None,
        typer.Option(
            "--for",
            metavar="TARGET",
            help="Program that will open the build jobs: generic, prusaslicer or cura.",
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Write a job file for these inputs, with every other key as a comment.

    Edit it, and run it with 'amprep run job.toml'. 'amprep schema' gives
    your editor the keys to complete and check.
    """
    from amprep.errors import AmprepError
    from amprep.files import replacing
    from amprep.host import Host
    from amprep.job import make_job
    from amprep.job.reference.template import template

    if not str(output).isprintable():
        raise AmprepError(f"{str(output)[:80]!r} is not a usable file name")
    if output.exists() and not force:
        raise AmprepError(f"{output} exists already; use --force to replace it, or -o for another file")
    host = Host.load()
    if packer is not None:
        host.choose("packer", packer)
    if cell is not None and not Path(cell).is_file():
        host.choose("cell", cell)
    folder = output.resolve().parent
    here = [os.path.relpath(each, folder) for each in inputs]
    stated = {
        "printer": _seen_from(folder, printer),
        "material": _seen_from(folder, material),
        "target": target,
        "packing.strategy": packer,
        "cells.strategy": _seen_from(folder, cell),
    }
    text = template(output.name, here, stated)
    make_job(
        tomllib.loads(text), name=output.stem, folder=folder, source=str(output)
    )  # raises for a wrong name
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    typer.echo(f"wrote {output}; run it by: amprep run {output}")


def _seen_from(folder: Path, name: str | None) -> str | None:
    """Return the path of a file relative to a folder; a name stays a name."""
    return os.path.relpath(name, folder) if name is not None and Path(name).is_file() else name
