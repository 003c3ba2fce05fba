"""``amprep run``: the main job."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep.cli import options as running

if TYPE_CHECKING:
    from amprep.host import Host
    from amprep.job import Job
    from amprep.pipeline.stages import Watcher
    from amprep.report.record import RunRecord


def run(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="INPUT...",
            help="Job files (.toml), 3MF jobs, mesh files, folders; NAME:4 asks for four copies.",
            show_default=False,
        ),
    ],
    output: running.Output = None,
    printer: running.PrinterName = None,
    packer: Annotated[str | None, typer.Option(help="Packer by name; see 'amprep plugins list'.")] = None,
    router: running.Router = None,
    cell: running.Cell = None,
    target: running.Target = None,
    supports_as: running.SupportsAs = None,
    lattice: running.Lattice = None,
    connector: running.Connector = None,
    base: running.Base = None,
    sets: running.Sets = None,
    seed: running.Seed = None,
    time_limit: running.TimeLimit = None,
    stl: running.Stl = False,
    allow_surface: running.AllowSurface = False,
    dry_run: running.DryRun = False,
    as_json: running.AsJson = False,
    quiet: running.Quiet = False,
    modules: running.Modules = None,
    no_plugins: running.NoPlugins = False,
    debug: running.Debug = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Pack, support and write build jobs, one 3MF for each printing run.

    Beside NAME.build-1.3mf and so on come NAME.report.html with a 3D view, NAME.report.json, and a picture of each
    build. Exit code 0: done; 1: done, but something is unplaced, unsupported or fails verification; 2: wrong input or
    usage, nothing written; 130: interrupted, nothing written.
    """

    def work(job: "Job", folder: Path, host: "Host", watcher: "Watcher") -> "RunRecord":
        from amprep.model import Stop
        from amprep.pipeline.run import RunOptions
        from amprep.pipeline.run import run as run_job

        options = RunOptions(folder, dry_run, stl, allow_surface, time_limit)
        return run_job(job, host, options, watcher=watcher, stop=Stop())

    running.carry_out(
        work,
        inputs,
        output=output,
        sets=sets or [],
        as_json=as_json,
        quiet=quiet,
        modules=modules or [],
        no_plugins=no_plugins,
        printer=printer,
        packer=packer,
        router=router,
        cell=cell,
        target=target,
        seed=seed,
        supports_as=supports_as,
        lattice=lattice,
        connector=connector,
        base=base,
    )
