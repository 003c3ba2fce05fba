"""``amprep inspect``: say what is in a file and what is wrong with it, and compare bounding volumes."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep.cli.jobs.reporting import finish
from amprep.cli.log import logging_to
from amprep.cli.options import (
    Debug,
    LogFile,
    NoPlugins,
    Plugins,
    Printer,
    Quiet,
    ReadingOptions,
    ResultAsJson,
    Sets,
    job_option,
    output_option,
    supervise_plugins,
    with_options,
)
from amprep.cli.stated import stated_job

if TYPE_CHECKING:
    from amprep.report.inspection.record import InspectionRecord


@dataclass(frozen=True, kw_only=True)
class InspectionOptions(ReadingOptions):
    """Options of the command that do not choose what is inspected."""

    printer: Printer = None
    sets: Sets = None
    time_limit: Annotated[
        float | None,
        job_option(
            "--time-limit",
            min=0.0,
            metavar="SECONDS",
            help="After this time, end volume makers with their best result and begin no other.",
        ),
    ] = None
    output: Annotated[
        Path | None,
        output_option(
            "-o",
            "--output",
            metavar="FOLDER",
            help="Folder for a page, a JSON report and pictures; default: none.",
        ),
    ] = None
    as_json: ResultAsJson = False
    quiet: Quiet = False
    log: LogFile = None
    plugins: Plugins = None
    no_plugins: NoPlugins = False
    debug: Debug = False


@with_options(InspectionOptions)
def inspect(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="PART",
            help="Mesh files, 3MF files and folders, or a job file (.toml).",
            show_default=False,
        ),
    ],
    volumes: Annotated[
        list[str] | None,
        typer.Option(
            "--volumes",
            metavar="MAKER",
            help="Compare bounding volumes: 'all', a volume maker, or a chain A,B; repeatable.",
        ),
    ] = None,
    *,
    options: InspectionOptions,
) -> None:
    """Say what is in a file, what is wrong with it, what needs support, and which printers it fits.

    With --volumes it bounds every part by each volume maker and prints the
    ratio of the volumes, the number of pieces, the time, and the verdict of
    the judge. With -o it writes NAME.inspect.html with a 3D view that switches
    between the part and its bounding volumes, NAME.inspect.json, and a picture
    of each volume.

    Exit codes: 0 if nothing is wrong, 1 if a part is not a solid, fits no
    printer or is not inside its bounding volume, 2 for wrong input, 130 or 143
    if Ctrl-C or SIGTERM ended it (nothing written).
    """
    record = _inspected(inputs, volumes or [], options)

    from amprep.report.inspection.json_form import to_json
    from amprep.report.inspection.terminal import summary

    finish(record, to_json, lambda found: summary(found, options.output or Path()), options)


def _inspected(inputs: list[str], volumes: list[str], options: InspectionOptions) -> "InspectionRecord":
    """Call the public API with progress bars."""
    supervise_plugins(
        options.plugins,
        without_plugins=options.no_plugins,
        output=options.output,
        time_limit=options.time_limit,
    )
    from rich.console import Console

    from amprep.cli.progress import Bars
    from amprep.host import Host

    job = stated_job(inputs, {"printer": options.printer, **options.reading}, options.sets)
    console = Console(stderr=True, quiet=options.quiet)
    with logging_to(options.log) as log, Bars(console, log) as bars:
        with bars.stage("start"):
            from amprep import api

            host = Host.load(modules=options.plugins or [], plugins_enabled=not options.no_plugins)
        return api.inspect(
            job,
            volumes=volumes,
            output=options.output,
            time_limit_s=options.time_limit,
            plugins=host,
            watcher=bars,
        )
