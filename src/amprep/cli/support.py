"""``amprep support``: supports for a plate as it lies."""

from typing import TYPE_CHECKING, Annotated

import typer

from amprep import cli
from amprep.cli import running

if TYPE_CHECKING:
    from amprep.host import Host
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
    from rich.console import Console

    from amprep.job import apply_sets, override

    job = override(
        running.job_of(inputs),
        printer=printer,
        router=router,
        cell=cell,
        target=target,
        seed=seed,
        supports_as=supports_as,
        lattice=lattice,
    )
    job = apply_sets(job, [*(sets or []), *([f"supports.grounding={grounding}"] if grounding else [])])
    console = Console(stderr=True, quiet=quiet)
    folder = output or running.beside(inputs[0])

    def work(host: "Host", watcher: "Watcher") -> "RunRecord":
        from amprep.model import Stop
        from amprep.pipeline.run import RunOptions
        from amprep.pipeline.support import support as support_job

        options = RunOptions(folder, dry_run, stl, allow_surface, time_limit)
        return support_job(job, host, options, center=center, watcher=watcher, stop=Stop())

    record = running.watched(job, console, work, modules=modules or [], no_plugins=no_plugins)
    running.print_record(record, as_json=as_json, quiet=quiet)
    raise typer.Exit(cli.INCOMPLETE if record.faults else cli.DONE)
