"""``amprep replan``: plan a build again that was edited in another program."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep import workers
from amprep.cli.jobs.reporting import finish, open_page
from amprep.cli.log import logging_to
from amprep.cli.options import (
    Debug,
    DryRun,
    Force,
    LogFile,
    NoPlugins,
    OpenReport,
    Plugins,
    ProgressForm,
    Quiet,
    ReportAsJson,
    Workers,
    output_option,
    supervise_plugins,
    with_options,
)

if TYPE_CHECKING:
    from amprep.report.replanning import ReplanRecord


@dataclass(frozen=True, kw_only=True)
class ReplanningOptions:
    """Options of `replan`."""

    job: Annotated[
        Path | None,
        typer.Option(metavar="JOB.toml", help="Plan by this job instead of the settings in the file."),
    ] = None
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="The JSON report beside the build that was edited, if a slicer dropped the record.",
        ),
    ] = None
    verify_all: Annotated[
        bool, typer.Option("--verify-all", help="Judge the supports that are kept, too.")
    ] = False
    time_limit: Annotated[
        float | None,
        typer.Option(
            "--time-limit",
            min=0.0,
            metavar="SECONDS",
            help="Stop routing after this time and use the best result.",
        ),
    ] = None
    output: Annotated[
        Path | None,
        output_option(
            "-o", "--output", metavar="FOLDER", help="Output folder; default: the folder of the file."
        ),
    ] = None
    html: Annotated[
        bool, output_option("--html", help="Write the page with a 3D view, too; --open implies it.")
    ] = False
    open_report: OpenReport = False
    force: Force = False
    dry_run: DryRun = False
    as_json: ReportAsJson = False
    quiet: Quiet = False
    progress: ProgressForm = "bars"
    plugins: Plugins = None
    no_plugins: NoPlugins = False
    workers: Workers = None
    log: LogFile = None
    debug: Debug = False


@with_options(ReplanningOptions)
def replan(
    build: Annotated[
        Path, typer.Argument(metavar="BUILD.3mf", help="A build file whose parts were edited in any program.")
    ],
    *,
    options: ReplanningOptions,
) -> None:
    """Plan a build again after parts were moved, turned, deleted, copied or added.

    Parts stay where they are in the file. Supports that still hold are kept:
    those of parts that did not move, and those that were moved along the plate
    with their part, if nothing is in their way. The others are planned again,
    by the settings that the build file records. Slicers drop the record when
    they save; it is then taken from the build file beside it whose identifier
    is in the names of objects, or from that of --report, or --job states it.

    It writes NAME.replanned.3mf and NAME.replanned.report.json. Those of an
    earlier call are replaced; where the 3MF file was changed since, only with
    --force.

    Exit codes: 0 if done, 1 if something is unsupported or fails verification,
    2 for wrong input, parts that collide or are outside the build volume
    (nothing written), 130 or 143 if Ctrl-C or SIGTERM ended it (nothing
    written).
    """
    folder = options.output or build.resolve().parent
    record = _replanned(build, folder, options)

    from amprep.report.replanning import summary, to_json

    if options.open_report:
        open_page(folder, [record.page_file])
    finish(record, to_json, lambda found: summary(found, folder), options)


def _replanned(build: Path, folder: Path, options: ReplanningOptions) -> "ReplanRecord":
    """Call the public API with progress bars."""
    supervise_plugins(
        options.plugins,
        without_plugins=options.no_plugins,
        output=folder,
        time_limit=options.time_limit,
    )
    from amprep.interruption import clean_with

    # until files are written, a signal may end the process at once
    clean_with(lambda: None)
    from rich.console import Console

    from amprep.cli.progress import Bars, Lines
    from amprep.host import Host

    as_lines = options.progress == "lines" and not options.quiet
    console = Console(stderr=True, quiet=options.quiet or as_lines)
    with logging_to(options.log) as log, Lines(log) if as_lines else Bars(console, log) as bars:
        with bars.stage("start"):
            from amprep import api

            host = Host.load(modules=options.plugins or [], plugins_enabled=not options.no_plugins)
        with workers.allowed(options.workers or workers.available()):
            return api.replan(
                build,
                output=folder,
                job=options.job,
                report=options.report,
                dry_run=options.dry_run,
                verify_all=options.verify_all,
                time_limit_s=options.time_limit,
                page=options.html or options.open_report,
                force=options.force,
                plugins=host,
                watcher=bars,
            )
