"""The commands ``list`` and ``show`` of profiles: `amprep printers` and `amprep materials` are two instances."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Generic, TypeVar

import typer

from amprep.cli.options import AsJson

T = TypeVar("T")


@dataclass(frozen=True)
class ProfileCommands(Generic[T]):
    """What the commands of one kind of profile do.

    Attributes
    ----------
    kind
        ``printer`` or ``material``.
    about
        Help of the command ``list``.
    listed
        Returns all profiles, and warnings.
    find
        Returns the profile with a name or path; raises `JobError` if there is none.
    record
        Returns what JSON says about a profile.
    unstated
        Keys of the record that are no keys of a profile file.
    print_table
        Prints profiles for the terminal.
    more
        What else the commands do.
    """

    kind: str
    about: str
    listed: Callable[[], tuple[list[T], list[str]]]
    find: Callable[[str], T]
    record: Callable[[T], dict[str, Any]]
    unstated: tuple[str, ...]
    print_table: Callable[[list[T]], None]
    more: str = "show one of them"

    def app(self) -> typer.Typer:
        """Return the application with the two commands; without a command it lists the profiles."""
        kind = self.kind
        app = typer.Typer(help=f"List the {kind}s that a job can name, or {self.more}.")
        name = typer.Argument(metavar=kind.upper(), help=f"Name of a {kind}, or path of a profile (.toml).")

        @app.callback(invoke_without_command=True)
        def _main(context: typer.Context) -> None:
            if context.invoked_subcommand is None:
                self.print_all(as_json=False)

        @app.command("list", help=self.about)
        def _list(as_json: AsJson = False) -> None:
            self.print_all(as_json)

        @app.command("show", help=f"Show one {kind} as a profile that can be saved to a file and changed.")
        def _show(called: Annotated[str, name], as_json: AsJson = False) -> None:
            self.print_one(called, as_json)

        return app

    def print_all(self, as_json: bool) -> None:
        """Print all profiles, and warnings about invalid ones to the standard error."""
        profiles, warnings = self.listed()
        for warning in warnings:
            typer.echo(f"amprep: warning: {warning}", err=True)
        if as_json:
            typer.echo(json.dumps([self.record(profile) for profile in profiles], indent=2))
        else:
            self.print_table(profiles)

    def print_one(self, name: str, as_json: bool) -> None:
        """Print one profile, as JSON or as the text of a profile file."""
        record = self.record(self.find(name))
        if as_json:
            typer.echo(json.dumps(record, indent=2))
            return
        from amprep.profiles import profile_text

        stated = {key: value for key, value in record.items() if key not in self.unstated}
        typer.echo(profile_text(stated), nl=False)
