"""The application with all commands."""

from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from amprep import __version__
from amprep.cli import bench
from amprep.cli.builds import compare, diff, hook, replan, seal, verify
from amprep.cli.builds import slice as slices
from amprep.cli.catalogues import cells, materials, plugins, printers
from amprep.cli.jobs import batch, orient, run, support
from amprep.cli.jobs import infill as lattice
from amprep.cli.jobs import inspect as inspection
from amprep.cli.setup import demo, doctor, init, schema, warm_up

_HELP_OPTIONS = ["-h", "--help"]


class FilesOrCommand(TyperGroup):
    """A group of commands whose arguments may also be files alone, as a file manager passes them: it runs the job."""

    def __init__(self, *args: Any, **named: Any) -> None:
        """Make the group; help shows no type beside options that take no value."""
        super().__init__(*args, **named)
        for each in self.commands.values():
            _hide_types_of_flags(each)

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the options of the group; typer adds some of them after the group was made."""
        return _without_types_of_flags(super().get_params(ctx))

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:  # typer may bring a click of its own
        """Parse arguments; those that begin with an existing file or folder, and no command, belong to `run`."""
        if args and args[0] not in self.commands and _exists(args[0]):
            args = ["run", *args]
        return list(super().parse_args(ctx, args))


def _exists(text: str) -> bool:
    with suppress(OSError, ValueError):  # no path can be as long, or contain a zero byte
        return Path(text).exists()
    return False


def _hide_types_of_flags(command: Any) -> None:
    """Hide the word ``<bool>``, by which ``--stl`` would seem to need a value, in the help of a command and below."""
    _without_types_of_flags(command.get_params(typer.Context(command, help_option_names=_HELP_OPTIONS)))
    for below in getattr(command, "commands", {}).values():
        _hide_types_of_flags(below)


def _without_types_of_flags(params: list[Any]) -> list[Any]:
    for each in params:
        if getattr(each, "is_flag", False):
            each.metavar = ""
    return params


app = typer.Typer(
    name="amprep",
    cls=FilesOrCommand,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": _HELP_OPTIONS},
    help="Prepare builds for additive manufacturing: pack parts, plan supports that stand on the plate, "
    "and write one 3MF build job per printing run.",
)
app.command("run")(run.run)
app.command("support")(support.support)
app.command("batch")(batch.batch)
app.command("watch")(batch.watch)
app.command("lattice")(lattice.lattice)
app.command("verify")(verify.verify)
app.command("seal")(seal.seal)
app.command("diff")(diff.diff)
app.command("compare")(compare.compare)
app.command("slice")(slices.slice_)
app.command("replan")(replan.replan)
app.command("inspect")(inspection.inspect)
app.command("orient")(orient.orient)
app.command("init")(init.init)
app.command("schema")(schema.schema)
app.command("demo")(demo.demo)
app.command("doctor")(doctor.doctor)
app.command("warm-up")(warm_up.warm_up)
app.add_typer(plugins.app, name="plugins")
app.add_typer(cells.app, name="cells")
app.add_typer(printers.app, name="printers")
app.add_typer(materials.app, name="materials")
app.add_typer(hook.app, name="hook")
app.add_typer(bench.app, name="bench")


def _version(value: bool) -> None:
    if value:
        typer.echo(f"amprep {__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Take the options that belong to no command."""
