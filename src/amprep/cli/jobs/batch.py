"""``amprep batch`` and ``amprep watch``: run many jobs."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from amprep import cli
from amprep.cli.options import (
    Debug,
    LogFile,
    Material,
    NoPlugins,
    Plugins,
    Printer,
    ProgressForm,
    Quiet,
    Sets,
    job_option,
    output_option,
    with_options,
)

if TYPE_CHECKING:
    from amprep.batch.queue import JobQueue
    from amprep.batch.records import BatchRecord
    from amprep.cli.progress import Bars, Lines


@dataclass(frozen=True, kw_only=True)
class BatchOptions:
    """Options of the commands that run many jobs."""

    printer: Printer = None
    material: Material = None
    sets: Sets = None
    time_limit: Annotated[
        float | None,
        job_option(
            "--time-limit",
            min=0.0,
            metavar="SECONDS",
            help="Time limit of each job: stop packing and routing after this time.",
        ),
    ] = None
    output: Annotated[
        Path | None,
        output_option(
            "-o",
            "--output",
            metavar="FOLDER",
            help="Folder with a folder for each job; default: the folder 'prepared' in the first folder given, "
            "or in the current one.",
        ),
    ] = None
    workers: Annotated[
        int | None,
        output_option(
            "--workers",
            min=1,
            metavar="COUNT",
            help="Largest number of jobs at a time; default: one for each core.",
        ),
    ] = None
    scheduler: Annotated[
        str | None,
        output_option(
            "--scheduler",
            metavar="ADDRESS",
            help="Run the jobs on a Dask cluster, for example tcp://host:8786; needs the package distributed.",
        ),
    ] = None
    again: Annotated[
        bool, output_option("--again", help="Run all jobs, also those that an earlier batch finished.")
    ] = False
    as_json: Annotated[bool, output_option("--json", help="Print the summary as JSON.")] = False
    quiet: Quiet = False
    progress: ProgressForm = "bars"
    plugins: Plugins = None
    no_plugins: NoPlugins = False
    log: LogFile = None
    debug: Debug = False

    @property
    def arguments(self) -> tuple[str, ...]:
        """The options of ``amprep run`` that every job gets."""
        single = {"--printer": self.printer, "--material": self.material, "--time-limit": self.time_limit}
        given = [f"{name}={value}" for name, value in single.items() if value is not None]
        given += [f"--set={each}" for each in self.sets or []]
        given += [f"--plugin={each}" for each in self.plugins or []]
        return (*given, *(["--no-plugins"] if self.no_plugins else []))


@with_options(BatchOptions)
def batch(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="JOB",
            help="Job files (.toml), 3MF files, and folders with them; each file is a job.",
            show_default=False,
        ),
    ],
    *,
    options: BatchOptions,
) -> None:
    """Run many jobs, each as 'amprep run' does, in a process and an output folder of its own.

    In folders, the jobs are all job files and the 3MF files that no job names.
    A job that fails or crashes is reported, and the others go on. When the
    same command is given again, finished jobs are not run again, unless their
    files, the options or the version of amprep changed.

    It writes batch.html and batch.json, up to date while jobs run.

    Exit codes: 0 if all jobs are done, 1 if one is not, 2 for wrong input,
    130 or 143 if Ctrl-C or SIGTERM ended it (finished jobs stay).
    """
    from amprep.batch.course import run_batch
    from amprep.batch.find import find_jobs

    folder = (options.output or _default_folder(inputs)).resolve()
    jobs = find_jobs(inputs, folder, options.arguments)
    with _shown(options) as (tell, bars):
        queue = _queue(options)
        with bars.stage("jobs") as progress:
            record = run_batch(jobs, queue, folder, progress=progress, tell=tell)
    _finish(record, folder, options)


@with_options(BatchOptions)
def watch(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="The folder in which jobs arrive.")],
    idle: Annotated[
        float | None,
        typer.Option(
            min=0.0, metavar="SECONDS", help="End when no job has arrived for this time; default: never."
        ),
    ] = None,
    *,
    options: BatchOptions,
) -> None:
    """Run the jobs that arrive in a folder, as 'amprep batch' does.

    A job begins when its files have not changed for 2 seconds and none of
    them is missing. It runs again when one of its files changes.

    Exit codes: 0 if all jobs are done, 1 if one is not, 2 for wrong input,
    130 or 143 if Ctrl-C or SIGTERM ended it (finished jobs stay).
    """
    from amprep.batch.watching import FolderWatch, watch_folder
    from amprep.errors import InputError

    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder")
    output = (options.output or _default_folder([folder])).resolve()
    with _shown(options) as (tell, _):
        tell(f"watching {folder}; Ctrl-C ends it")
        queue = _queue(options)
        record = watch_folder(
            FolderWatch(folder, output, options.arguments), queue, output, idle_s=idle, tell=tell
        )
    _finish(record, output, options)


def _default_folder(inputs: list[Path]) -> Path:
    return next((each for each in inputs if each.is_dir()), Path()) / "prepared"


def _queue(options: BatchOptions) -> "JobQueue":
    from amprep.batch.cluster import ClusterQueue
    from amprep.batch.queue import LocalQueue
    from amprep.workers import available

    if options.scheduler is not None:
        return ClusterQueue(options.scheduler, again=options.again)
    return LocalQueue(options.workers or available(), again=options.again)


@contextmanager
def _shown(options: BatchOptions) -> "Iterator[tuple[Callable[[str], None], Bars | Lines]]":
    """Yield a function that prints and logs a line, and what shows the progress."""
    from rich.console import Console

    from amprep.cli.log import logging_to
    from amprep.cli.progress import Bars, Lines

    as_lines = options.progress == "lines" and not options.quiet
    console = Console(stderr=True, quiet=options.quiet or as_lines)
    with logging_to(options.log) as log, Lines(log) if as_lines else Bars(console, log) as bars:

        def tell(line: str) -> None:
            log(line)
            console.print(line, markup=False, highlight=False)

        yield tell, bars


def _finish(record: "BatchRecord", folder: Path, options: BatchOptions) -> NoReturn:
    """Print the summary as JSON, or as a table unless the user asked for quiet, and exit."""
    from rich.console import Console

    from amprep.batch.summary import to_json
    from amprep.batch.terminal import summary

    if options.as_json:
        typer.echo(json.dumps(to_json(record), indent=2))
    elif not options.quiet:
        Console().print(summary(record, folder))
    raise typer.Exit(cli.INCOMPLETE if record.faults else cli.DONE)
