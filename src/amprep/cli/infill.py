"""``amprep lattice``: fill marked regions of parts with lattice cells."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep import cli
from amprep.cli import options as running

if TYPE_CHECKING:
    from amprep.report.infill import LatticeRecord


def lattice(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...",
            help="3MF files whose parts carry modifiers, mesh files with --region or --shell, a job file (.toml).",
            show_default=False,
        ),
    ],
    cell: running.Cell = None,
    region: Annotated[
        list[Path] | None,
        typer.Option(
            "--region",
            metavar="MESH",
            help="Mesh file of a region, in the coordinates of the input; repeatable.",
        ),
    ] = None,
    region_name: Annotated[
        list[str] | None,
        typer.Option("--region-name", metavar="NAME", help="Fill only the region of this name; repeatable."),
    ] = None,
    shell: Annotated[
        float | None,
        typer.Option("--shell", metavar="MM", help="Fill all that lies deeper than this below the surface."),
    ] = None,
    size: Annotated[
        float | None,
        typer.Option("--size", metavar="MM", help="Size of a cell; default 5, less in small regions."),
    ] = None,
    height: Annotated[
        float | None, typer.Option("--height", metavar="MM", help="Height of a cell; default: its size.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Output folder, or the file to write (.3mf); default: beside the first input.",
        ),
    ] = None,
    target: running.Target = None,
    form: running.Lattice = None,
    sets: running.Sets = None,
    stl: running.Stl = False,
    dry_run: running.DryRun = False,
    as_json: running.AsJson = False,
    quiet: running.Quiet = False,
    modules: running.Modules = None,
    no_plugins: running.NoPlugins = False,
    debug: running.Debug = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Fill marked regions of parts with lattice cells, one with the solid around them.

    A region is a modifier of the part in a 3MF (PrusaSlicer, OrcaSlicer, Bambu Studio, Cura), a mesh given by
    --region, or with --shell everything but a wall of that thickness. Writes NAME.lattice.3mf, which 'amprep run'
    and slicers read, NAME.lattice.report.json and a picture of the parts cut open. Exit code 0: done; 1: done, but a
    promise is broken; 2: wrong input or usage, nothing written; 130: interrupted, nothing written.
    """
    from rich.console import Console

    from amprep.cli.progress import Bars
    from amprep.host import Host
    from amprep.job import apply_sets, override

    job = apply_sets(override(running.job_of(inputs), cell=cell, target=target, lattice=form), sets or [])
    with Bars(Console(stderr=True, quiet=quiet)) as bars:
        with bars.stage("start"):
            from amprep.model import Stop
            from amprep.pipeline.fill_parts import LatticeOptions, fill_lattice

            host = Host.load(modules=modules or [], plugins_enabled=not no_plugins)
        folder, stem = _place(output, inputs[0], job.name)
        options = LatticeOptions(
            folder, stem, tuple(region or ()), tuple(region_name or ()), shell, size, height, stl, dry_run
        )
        record = fill_lattice(job, host, options, watcher=bars, stop=Stop())
    _show(record, as_json=as_json, quiet=quiet)
    raise typer.Exit(cli.INCOMPLETE if record.faults else cli.DONE)


def _place(output: Path | None, first: str, name: str) -> tuple[Path, str]:
    """Return the output folder and the stem of the files' names."""
    if output is not None and output.suffix.lower() == ".3mf":
        return output.resolve().parent, output.stem
    return output or running.beside(first), f"{name}.lattice"


def _show(record: "LatticeRecord", *, as_json: bool, quiet: bool) -> None:
    from rich.console import Console

    from amprep.report.infill import summary, to_json

    if as_json:
        typer.echo(json.dumps(to_json(record), indent=2))
    elif not quiet:
        Console().print(summary(record))
