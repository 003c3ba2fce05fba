"""Make the job of a command from its inputs and options, run it with progress bars, and print the result."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from amprep import cli
from amprep.cli.options import BuildOptions, JobOptions

if TYPE_CHECKING:
    from rich.console import Console

    from amprep.host import Host
    from amprep.job import Job
    from amprep.pipeline.stages import Watcher
    from amprep.report.record import RunRecord


def make_job(inputs: list[str], options: JobOptions, changes: Mapping[str, Any]) -> "Job":
    """Return the job of the inputs, changed by the options and then by ``--set``."""
    from amprep.job import apply_sets, job_of, override

    return apply_sets(override(job_of(inputs), {**options.changes, **changes}), options.sets or [])


def build_and_report(
    work: "Callable[[Job, Path, Host, Watcher], RunRecord]",
    inputs: list[str],
    options: BuildOptions,
    changes: Mapping[str, Any],
) -> NoReturn:
    """Do the work on a job with progress bars, print its record and exit.

    Parameters
    ----------
    work
        Takes the job, the output folder, the host and the watcher, and returns the record of the run.
    inputs
        Inputs as given on the command line.
    options
        Options that the commands share.
    changes
        Settings of the job that other options change, by dotted keys; None leaves a setting as it is.
    """
    from rich.console import Console

    job = make_job(inputs, options, changes)
    console = Console(stderr=True, quiet=options.quiet)
    if job.printer_is_default:
        console.print(f"[dim]no printer given, using {job.printer.name}; see 'amprep printers list'")
    folder = folder_of(inputs, options)
    record = watched(lambda host, watcher: work(job, folder, host, watcher), console, options)

    from amprep.report.json_report import to_json
    from amprep.report.terminal import summary

    show(lambda: to_json(record), lambda: summary(record, _shown(folder)), options)
    raise typer.Exit(cli.INCOMPLETE if record.faults else cli.DONE)


def watched(work: "Callable[[Host, Watcher], Any]", console: "Console", options: JobOptions) -> Any:
    """Load the plugins and do the work with progress bars; heavy modules are imported while a bar shows."""
    from amprep.cli.progress import Bars
    from amprep.host import Host

    with Bars(console) as bars:
        with bars.stage("start"):
            import amprep.api  # noqa: F401 - importing it takes most of the start

            host = Host.load(modules=options.plugins or [], plugins_enabled=not options.no_plugins)
        for warning in host.warnings:
            console.print(f"warning: {warning}", markup=False)
        return work(host, bars)


def folder_of(inputs: list[str], options: JobOptions) -> Path:
    """Return the output folder: the one given, or the folder that contains the first input."""
    from amprep.job.loading import parse_input

    return options.output or parse_input(inputs[0], "inputs").path.resolve().parent


def _shown(folder: Path) -> Path:
    """Return the folder relative to the current one if it is inside."""
    here = Path.cwd()
    return folder.relative_to(here) if folder.is_relative_to(here) else folder


def show(as_json: Callable[[], Any], as_table: Callable[[], Any], options: JobOptions) -> None:
    """Print a record as JSON, or as a table unless the user asked for quiet."""
    import json

    from rich.console import Console

    if options.as_json:
        typer.echo(json.dumps(as_json(), indent=2))
    elif not options.quiet:
        Console().print(as_table())
