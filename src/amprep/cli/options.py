"""What ``amprep run`` and ``amprep support`` share: options, and the course from inputs to exit code."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from amprep import cli
from amprep.errors import JobError

if TYPE_CHECKING:
    from rich.console import Console

    from amprep.host import Host
    from amprep.job import Job
    from amprep.pipeline.stages import Watcher
    from amprep.report.record import RunRecord

    Work = Callable[[Job, Path, Host, Watcher], RunRecord]

Output = Annotated[
    Path | None, typer.Option("-o", "--output", help="Output folder; default: beside the first input.")
]
PrinterName = Annotated[
    str | None, typer.Option("--printer", help="Printer profile by name or file; see 'amprep printers list'.")
]
Router = Annotated[str | None, typer.Option("--router", help="Support router by name.")]
Cell = Annotated[str | None, typer.Option("--cell", help="Lattice cell by name.")]
Target = Annotated[
    str | None,
    typer.Option("--for", metavar="TARGET", help="Who opens the build jobs: generic, prusaslicer or cura."),
]
SupportsAs = Annotated[
    str | None,
    typer.Option(
        "--supports-as",
        metavar="TYPE",
        help="What a generic file says supports are: support (default) or model.",
    ),
]
Lattice = Annotated[
    str | None,
    typer.Option(
        "--lattice",
        metavar="FORM",
        help="Struts of cells as beams (generic files only) or mesh; default: as the cell's parameters say.",
    ),
]
Connector = Annotated[
    str | None,
    typer.Option(
        "--connector", metavar="KIND", help="How supports end at the part: full, teeth, point or extend."
    ),
]
Base = Annotated[
    str | None,
    typer.Option(
        "--base", metavar="KIND", help="What supports stand on at the plate: direct, flange or raft."
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set any key of the job file: supports.pitch_mm=0.8"),
]
Seed = Annotated[int | None, typer.Option("--seed", help="Seed of everything random; default 0.")]
TimeLimit = Annotated[
    float | None,
    typer.Option(
        "--time-limit",
        min=0.0,
        metavar="SECONDS",
        help="Packing and routing end by then with their best so far.",
    ),
]
Stl = Annotated[bool, typer.Option("--stl", help="Write parts and supports as STL too.")]
AllowSurface = Annotated[
    bool, typer.Option("--allow-surface", help="Pack and support meshes that are no solids as they are.")
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Plan and judge everything, write nothing.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the report as JSON on standard output.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no table; errors only.")]
Modules = Annotated[
    list[str] | None,
    typer.Option("-p", "--plugin", metavar="MODULE", help="Load a plugin module too; no:NAME blocks one."),
]
NoPlugins = Annotated[bool, typer.Option("--no-plugins", help="Use the built-in plugins only.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks.")]


def job_of(inputs: list[str]) -> "Job":
    """Return the job that the inputs name; a job file stands alone: what it prints and how is written in it."""
    from amprep.job import job_from_inputs, load_job

    job_files = [name for name in inputs if name.lower().endswith(".toml")]
    if not job_files:
        return job_from_inputs(inputs)
    if len(inputs) > 1:
        raise JobError(
            f"a job file comes alone, got {len(inputs)} inputs; list them as inputs = [...] in {job_files[0]}"
        )
    return load_job(Path(job_files[0]))


def carry_out(
    work: "Work",
    inputs: list[str],
    *,
    output: Path | None,
    sets: list[str],
    as_json: bool,
    quiet: bool,
    modules: list[str],
    no_plugins: bool,
    **overrides: Any,
) -> NoReturn:
    """Settle the job, do the work on it with progress bars, print what came out and exit.

    Parameters
    ----------
    work
        Takes the job, the output folder, the host and the watcher.
    overrides
        As `amprep.job.override` takes them; None leaves what the job says.
    """
    from rich.console import Console

    from amprep.job import apply_sets, override

    job = apply_sets(override(job_of(inputs), **overrides), sets)
    console, folder = Console(stderr=True, quiet=quiet), output or beside(inputs[0])
    record = _watched(work, job, folder, console, modules=modules, no_plugins=no_plugins)
    print_record(record, as_json=as_json, quiet=quiet)
    raise typer.Exit(cli.INCOMPLETE if record.faults else cli.DONE)


def _watched(
    work: "Work", job: "Job", folder: Path, console: "Console", *, modules: list[str], no_plugins: bool
) -> "RunRecord":
    """Do the work with progress bars; nothing heavy is imported before they show."""
    from amprep.cli.progress import Bars
    from amprep.host import Host

    if job.printer_is_default:
        console.print(f"[dim]no printer given, using {job.printer.name}; see 'amprep printers list'")
    with Bars(console) as bars:
        with bars.stage("start"):
            import amprep.pipeline.run  # noqa: F401 - loading it is part of the start

            host = Host.load(modules=modules, plugins_enabled=not no_plugins)
        for warning in host.warnings:
            console.print(f"warning: {warning}", markup=False)
        return work(job, folder, host, bars)


def beside(first: str) -> Path:
    """Folder of the first input; a folder's own outputs lie beside it, so that a second run does not read them."""
    from amprep.job.loading import parse_input

    return parse_input(first, "inputs").path.resolve().parent


def print_record(record: "RunRecord", *, as_json: bool, quiet: bool) -> None:
    """Print the report as JSON, or the closing table unless `quiet`."""
    import json

    from rich.console import Console

    from amprep.report.json_report import to_json
    from amprep.report.terminal import summary

    if as_json:
        typer.echo(json.dumps(to_json(record), indent=2))
    elif not quiet:
        Console().print(summary(record))
