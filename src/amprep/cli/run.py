"""``amprep run``: the main job."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep import cli
from amprep.errors import JobError

if TYPE_CHECKING:
    from rich.console import Console

    from amprep.job import Job
    from amprep.report.record import RunRecord

Modules = Annotated[
    list[str] | None,
    typer.Option("-p", "--plugin", metavar="MODULE", help="Load a plugin module too; no:NAME blocks one."),
]
NoPlugins = Annotated[bool, typer.Option("--no-plugins", help="Use the built-in plugins only.")]


def run(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="INPUT...",
            help="Job files (.toml), 3MF jobs, mesh files, folders; NAME:4 asks for four copies.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Output folder; default: beside the first input.")
    ] = None,
    printer: Annotated[
        str | None, typer.Option(help="Printer profile by name or file; see 'amprep printers list'.")
    ] = None,
    packer: Annotated[str | None, typer.Option(help="Packer by name; see 'amprep plugins list'.")] = None,
    router: Annotated[str | None, typer.Option(help="Support router by name.")] = None,
    cell: Annotated[str | None, typer.Option(help="Lattice cell by name.")] = None,
    target: Annotated[
        str | None,
        typer.Option(
            "--for", metavar="TARGET", help="Who opens the build jobs: generic, prusaslicer or cura."
        ),
    ] = None,
    sets: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Set any key of the job file: supports.pitch_mm=0.8"),
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of everything random; default 0.")] = None,
    time_limit: Annotated[
        float | None,
        typer.Option(
            min=0.0, metavar="SECONDS", help="Packing and routing end by then with their best so far."
        ),
    ] = None,
    stl: Annotated[bool, typer.Option("--stl", help="Write parts and supports as STL too.")] = False,
    allow_surface: Annotated[
        bool, typer.Option("--allow-surface", help="Pack and support meshes that are no solids as they are.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Plan and judge everything, write nothing.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the report as JSON on standard output.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no table; errors only.")] = False,
    modules: Modules = None,
    no_plugins: NoPlugins = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show tracebacks.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Pack, support and write build jobs, one 3MF for each printing run.

    Beside NAME.build-1.3mf and so on come NAME.report.html with a 3D view, NAME.report.json, and a picture of each
    build. Exit code 0: done; 1: done, but something is unplaced, unsupported or fails verification; 2: wrong input or
    usage, nothing written; 130: interrupted, nothing written.
    """
    from rich.console import Console

    from amprep.job import apply_sets, override

    job = override(
        _job(inputs), printer=printer, packer=packer, router=router, cell=cell, target=target, seed=seed
    )
    job = apply_sets(job, sets or [])
    console = Console(stderr=True, quiet=quiet)
    if job.printer_is_default:
        console.print(f"[dim]no printer given, using {job.printer.name}; see 'amprep printers list'")
    record = _watched(
        job,
        output or _beside(inputs[0]),
        console,
        modules=modules or [],
        no_plugins=no_plugins,
        dry_run=dry_run,
        stl=stl,
        allow_surface=allow_surface,
        time_limit=time_limit,
    )
    _print(record, as_json=as_json, quiet=quiet)
    raise typer.Exit(cli.INCOMPLETE if record.faults else cli.DONE)


def _watched(
    job: "Job",
    folder: Path,
    console: "Console",
    *,
    modules: list[str],
    no_plugins: bool,
    **options: bool | float | None,
) -> "RunRecord":
    """Run with progress bars; nothing heavy is imported before they show."""
    from amprep.cli.progress import Bars
    from amprep.host import Host

    with Bars(console) as bars:
        with bars.stage("start"):
            from amprep.model import Stop
            from amprep.pipeline.run import RunOptions
            from amprep.pipeline.run import run as run_job

            host = Host.load(modules=modules, plugins_enabled=not no_plugins)
        for warning in host.warnings:
            console.print(f"warning: {warning}", markup=False)
        return run_job(job, host, RunOptions(folder, **options), watcher=bars, stop=Stop())  # type: ignore[arg-type]


def _job(inputs: list[str]) -> "Job":
    """Return the job; a job file stands alone: what it prints and how is written in it."""
    from amprep.job import job_from_inputs, load_job

    job_files = [name for name in inputs if name.lower().endswith(".toml")]
    if not job_files:
        return job_from_inputs(inputs)
    if len(inputs) > 1:
        raise JobError(
            f"a job file comes alone, got {len(inputs)} inputs; list them as inputs = [...] in {job_files[0]}"
        )
    return load_job(Path(job_files[0]))


def _beside(first: str) -> Path:
    """Folder of the first input; a folder's own outputs lie beside it, so that a second run does not read them."""
    from amprep.job.loading import parse_input

    return parse_input(first, "inputs").path.resolve().parent


def _print(record: "RunRecord", *, as_json: bool, quiet: bool) -> None:
    import json

    from rich.console import Console

    from amprep.report.json_report import to_json
    from amprep.report.table import summary

    if as_json:
        typer.echo(json.dumps(to_json(record), indent=2))
    elif not quiet:
        Console().print(summary(record))
