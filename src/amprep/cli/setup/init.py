"""``amprep init``: write a job file with every key and its meaning."""

import os
import tomllib
from pathlib import Path
from typing import Annotated

import typer

from amprep.cli.options import Cell, Force, Material, Packer, Printer, Target
from amprep.cli.stated import options_named


def init(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="INPUT",
            help="Files and folders of the job; NAME:4 prints four copies.",
            show_default=False,
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE.toml", help="The job file.")] = Path(
        "job.toml"
    ),
    printer: Printer = None,
    material: Material = None,
    packer: Packer = None,
    cell: Cell = None,
    target: Target = None,
    force: Force = False,
) -> None:
    """Write a job file for these inputs, with every other key as a comment.

    Edit it, and run it with 'amprep run job.toml'. 'amprep schema' gives
    your editor the keys to complete and check.

    Exit codes: 0 if done, 2 if the job could not run: an input does not exist
    or has no file to read, or an option has a wrong value (nothing written).
    """
    from amprep.errors import AmprepError
    from amprep.files import replacing
    from amprep.host import Host
    from amprep.job import make_job
    from amprep.job.reference.template import template
    from amprep.pipeline.reading import expand_inputs

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
    with options_named(stated, str(output)):
        job = make_job(tomllib.loads(text), name=output.stem, folder=folder, source=str(output))
    expand_inputs(
        [(each.path, each.quantity) for each in job.inputs], host.suffixes
    )  # raises if nothing can be read
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    typer.echo(f"wrote {output}; run it by: amprep run {output}")


def _seen_from(folder: Path, name: str | None) -> str | None:
    """Return the path of a file relative to a folder; a name stays a name."""
    return os.path.relpath(name, folder) if name is not None and Path(name).is_file() else name
