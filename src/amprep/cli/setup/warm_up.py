"""``amprep warm-up``: compile kernels before jobs need them."""

import typer

from amprep import cli
from amprep.cli.options import Debug, NoPlugins, Plugins, ProgressForm, Quiet, supervise_plugins


def warm_up(
    quiet: Quiet = False,
    progress: ProgressForm = "bars",
    plugins: Plugins = None,
    no_plugins: NoPlugins = False,
    debug: Debug = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Compile the numeric code for this machine now, so that usual jobs do not wait for that.

    It solves small problems with every packer, volume maker, router and cell.

    Use it once after the installation, when an image for containers is made, or
    on each kind of machine of a cluster. The compiled code is kept beside the
    installed files, or in the folder that NUMBA_CACHE_DIR names.

    Exit codes: 0 if done, 130 or 143 if Ctrl-C or SIGTERM ended it.
    """
    supervise_plugins(plugins, without_plugins=no_plugins)
    from rich.console import Console

    from amprep.cli.progress import Bars, Lines
    from amprep.cli.setup.kernels import compiled_kernels
    from amprep.host import Host

    as_lines = progress == "lines" and not quiet
    console = Console(stderr=True, quiet=quiet or as_lines)
    with Lines() if as_lines else Bars(console) as bars:
        with bars.stage("start"):
            from amprep.bench.warming import warm_up as compile_all

            host = Host.load(modules=plugins or [], plugins_enabled=not no_plugins)
        compile_all(plugins=host, watcher=bars)
    if not quiet:
        typer.echo(f"compiled functions: {compiled_kernels()}")
    raise typer.Exit(cli.DONE)
