"""Make the job of a command, call the public API with progress bars, and print the result."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from amprep import cli, workers
from amprep.cli.log import logging_to
from amprep.cli.options import BuildOptions, JobOptions, supervise_plugins
from amprep.cli.stated import stated_job

if TYPE_CHECKING:
    from rich.console import RenderableType

    from amprep.cli.builds.replan import ReplanningOptions
    from amprep.cli.jobs.inspect import InspectionOptions
    from amprep.cli.jobs.orient import OrientationOptions
    from amprep.report.infill import InfillRecord
    from amprep.report.inspection.record import InspectionRecord
    from amprep.report.orientation.record import OrientationRecord
    from amprep.report.record import RunRecord
    from amprep.report.regions import RegionsRecord
    from amprep.report.replanning import ReplanRecord


def call_api(
    function: str,
    inputs: list[str],
    options: "JobOptions | OrientationOptions",
    changes: Mapping[str, Any],
    **own: Any,
) -> Any:
    """Call a function of the public API on a job with progress bars and return its record.

    Heavy modules are imported and plugins are loaded while the first bar shows.

    Parameters
    ----------
    function
        Name in `amprep.api`.
    inputs
        Inputs as given on the command line.
    options
        Options that the commands share.
    changes
        Settings of the job that other options change, by dotted keys; None leaves a setting as it is.
    own
        Further arguments of the function.
    """
    supervise_plugins(
        options.plugins,
        without_plugins=options.no_plugins,
        output=own.get("output"),
        time_limit=own.get("time_limit_s"),
    )
    from amprep.interruption import clean_with

    # until files are written, a signal may end the process at once: raised in a callback, an exception would be ignored
    clean_with(lambda: None)
    from rich.console import Console

    from amprep.cli.progress import Bars, Lines
    from amprep.host import Host
    from amprep.job.user_settings import with_user_settings

    stated = stated_job(inputs, {**options.changes, **changes}, options.sets)
    job, taken, settings = with_user_settings(stated)
    as_lines = options.progress == "lines" and not options.quiet
    console = Console(stderr=True, quiet=options.quiet or as_lines)
    if taken:
        words = ", ".join(f"{key} {value}" for key, value in taken.items())
        console.print(f"{words}, as {settings} states", style="dim", markup=False)
    if job.printer_is_default and isinstance(options, BuildOptions):
        console.print(f"[dim]no printer given, using {job.printer.name}; see 'amprep printers list'")
    with logging_to(options.log) as log, Lines(log) if as_lines else Bars(console, log) as bars:
        with bars.stage("start"):
            from amprep import api  # importing it takes most of the start

            host = Host.load(modules=options.plugins or [], plugins_enabled=not options.no_plugins)
        for warning in host.warnings:
            log(f"warning: {warning}")
            console.print(f"warning: {warning}", markup=False)
        with workers.allowed(options.workers or workers.available()):
            return getattr(api, function)(job, plugins=host, watcher=bars, **own)


def build_and_report(
    function: str, inputs: list[str], options: BuildOptions, changes: Mapping[str, Any], **own: Any
) -> NoReturn:
    """Make build jobs by a function of the public API, as `call_api` does, print the record and exit."""
    own |= {"allow_surface": options.allow_surface, "time_limit_s": options.time_limit}
    own |= output_options(inputs, options)
    record = call_api(function, inputs, options, changes, **own)

    from amprep.report.json_report import to_json
    from amprep.report.terminal import summary

    folder = _shown(folder_of(inputs, options))
    if options.open_report:
        open_page(folder, record.report_files)
    finish(record, to_json, lambda shown: summary(shown, folder), options)


def open_page(folder: Path, names: Sequence[str]) -> None:
    """Open the page among the reports in the browser; a dry run has none."""
    for name in names:
        if name.endswith(".html"):
            typer.launch(str(folder / name))


def explain_and_report(inputs: list[str], part: str, options: BuildOptions, *, center: bool) -> NoReturn:
    """Print the overhang regions of a part and exit; the table is the result, so `--quiet` prints it, too."""
    own = {"part": part, "center": center, "allow_surface": options.allow_surface}
    record = call_api("explain_regions", inputs, options, {}, **own)

    from amprep.report.regions import summary, to_json

    finish(record, to_json, summary, replace(options, quiet=False))


def output_options(inputs: list[str], options: JobOptions) -> dict[str, Any]:
    """Return the arguments of functions that write files: folder, whether nothing is written, and STL files."""
    return {"output": folder_of(inputs, options), "dry_run": options.dry_run, "stl": options.stl}


def folder_of(inputs: list[str], options: JobOptions) -> Path:
    """Return the output folder: the one given, or the folder that contains the first input."""
    from amprep.job.loading import parse_input

    return options.output or parse_input(inputs[0], "inputs").path.resolve().parent


def _shown(folder: Path) -> Path:
    """Return the folder relative to the current one if it is inside."""
    here = Path.cwd()
    return folder.relative_to(here) if folder.is_relative_to(here) else folder


def finish(
    record: "RunRecord | InfillRecord | InspectionRecord | OrientationRecord | RegionsRecord | ReplanRecord",
    to_json: Callable[[Any], Any],
    summary: "Callable[[Any], RenderableType]",
    options: "JobOptions | InspectionOptions | OrientationOptions | ReplanningOptions",
) -> NoReturn:
    """Print a record as JSON, or as a table unless the user asked for quiet, and exit."""
    from rich.console import Console

    if options.as_json:
        typer.echo(json.dumps(to_json(record), indent=2))
    elif not options.quiet:
        Console().print(summary(record))
    raise typer.Exit(cli.INCOMPLETE if record.faults else cli.DONE)
