"""``amprep bench``: run benchmarks and check every result independently."""

import typer

from amprep.cli.bench.collision import collision
from amprep.cli.bench.merging import merging
from amprep.cli.bench.packing import container_loading, esicup, mpv, packing
from amprep.cli.bench.plates import plates
from amprep.cli.bench.routing import supports
from amprep.cli.bench.support_volume import support_volume

app = typer.Typer(
    no_args_is_help=True, help="Run benchmarks on named instances; every result is checked independently."
)
app.command("mpv")(mpv)
app.command("container-loading")(container_loading)
app.command("esicup")(esicup)
app.command("plates")(plates)
app.command("packing")(packing)
app.command("supports")(supports)
app.command("support-volume")(support_volume)
app.command("merging")(merging)
app.command("collision")(collision)
