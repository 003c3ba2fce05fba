"""``amprep support``: supports for a plate as it lies."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep.cli import options as running

if TYPE_CHECKING:
    from amprep.host import Host
    from amprep.job import Job
    from amprep.pipeline.stages import Watcher
    from amprep.report.record import RunRecord


def support(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...",
            help="A 3MF plate, a job file (.toml), mesh files in their own coordinates.",
            show_default=False,
        ),
    ],
    output: running.Output = None,
    printer: running.PrinterName = None,
    center: Annotated[
        bool, typer.Option("--center", help="First move everything to the middle of the plate, onto it.")
    ] = False,
    grounding: Annotated[
        str | None,
        typer.Option(
            metavar="WHERE",
            help="plate, or anywhere: supports without a way to the plate may stand on parts.",
        ),
    ] = None,
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
    """Plan supports for a plate as it lies; nothing is packed.

    Parts stay where the build items of a 3MF put them, meshes of other formats where their own coordinates do; each
    must lie in the build volume, plate at z = 0. Writes NAME.supported.3mf, NAME.supported.report.html and .json, and
    a picture. Exit codes as of 'amprep run'.
    """

    def work(job: "Job", folder: Path, host: "Host", watcher: "Watcher") -> "RunRecord":
        from amprep.model import Stop
        from amprep.pipeline.run import RunOptions
        from amprep.pipeline.support_plate import support as support_job

        options = RunOptions(folder, dry_run, stl, allow_surface, time_limit)
        return support_job(job, host, options, center=center, watcher=watcher, stop=Stop())

    running.carry_out(
        work,
        inputs,
        output=output,
        sets=[*(sets or []), *([f"supports.grounding={grounding}"] if grounding else [])],
        as_json=as_json,
        quiet=quiet,
        modules=modules or [],
        no_plugins=no_plugins,
        printer=printer,
        router=router,
        cell=cell,
        target=target,
        seed=seed,
        supports_as=supports_as,
        lattice=lattice,
        connector=connector,
        base=base,
    )
