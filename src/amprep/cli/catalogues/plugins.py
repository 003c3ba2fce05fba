"""``amprep plugins``: list all offers, check a plugin, start a new plugin."""

import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from amprep import cli
from amprep.cli.options import AsJson, supervise_plugins

if TYPE_CHECKING:
    from amprep.hookspecs import Offer
    from amprep.host import Host, Listed
    from amprep.testing.conformance import OfferReport

Modules = Annotated[
    list[str] | None,
    typer.Option(
        "-p", "--plugin", metavar="MODULE", help="Load a plugin module too; no:NAME blocks a plugin."
    ),
]

app = typer.Typer(no_args_is_help=True, help="List what plugins offer, check a plugin, or start a new one.")


@app.command("list")
def list_all(
    as_json: AsJson = False,
    modules: Modules = None,
    no_plugins: Annotated[bool, typer.Option("--no-plugins", help="Use the built-in plugins only.")] = False,
) -> None:
    """List all packers, volume makers, support routers, lattice cells and mesh readers, with their plugins."""
    supervise_plugins(modules, without_plugins=no_plugins)
    from amprep.host import Host

    host = Host.load(modules=modules or [], plugins_enabled=not no_plugins)
    if as_json:
        typer.echo(json.dumps(_record(host), indent=2))
        return
    for warning in host.warnings:
        typer.echo(f"amprep: warning: {warning}", err=True)
    _print_offers(host)


@app.command("check")
def check(
    package: Annotated[
        str,
        typer.Argument(
            metavar="PLUGIN", help="Name of a plugin, distribution or module, or path of a module."
        ),
    ],
    sample: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Sample file for a mesh reader whose format amprep cannot write; repeatable.",
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check a plugin: run each of its offers on sample problems and judge the results.

    Exit codes: 0 if every promise holds, 1 if one is broken, 2 if the plugin
    cannot be loaded.
    """
    supervise_plugins([package])
    from amprep.testing.conformance import try_plugin

    trials = try_plugin(package, samples=sample or [])
    if as_json:
        typer.echo(json.dumps([asdict(trial) for trial in trials], indent=2))
    else:
        _print_trials(trials)
    raise typer.Exit(cli.DONE if all(trial.passed for trial in trials) else cli.INCOMPLETE)


@app.command("new")
def new(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Name of the package, for example amprep-shelves.")
    ],
    kind: Annotated[
        str, typer.Option(metavar="KIND", help="Kind of the offer: packer, cell, router, volume or reader.")
    ] = "packer",
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FOLDER", help="Folder for the new package.")
    ] = Path(),
) -> None:
    """Start a plugin: make a package with an offer that works and tests that pass."""
    from amprep.host.scaffold import make_plugin

    folder = make_plugin(name, kind, output)
    typer.echo(f"made {folder}; install and check it:")
    typer.echo(f"  python -m pip install -e {folder} && amprep plugins check {name}")


def _record(host: "Host") -> dict[str, Any]:
    from amprep.hookspecs import API_VERSION
    from amprep.host import KINDS

    offers = [_offer_record(each) for kind in KINDS for each in host.offers(kind).values()]
    return {"api": API_VERSION, "offers": offers, "warnings": host.warnings}


def _offer_record(listed: "Listed[Offer]") -> dict[str, Any]:
    defaults = listed.offer.params()
    return {
        "kind": listed.kind,
        "name": listed.offer.name,
        "summary": listed.offer.summary,
        "plugin": listed.plugin,
        "distribution": listed.distribution,
        "version": listed.version,
        "builtin": listed.builtin,
        "params": {
            field.name: _plain(getattr(defaults, field.name)) for field in fields(defaults) if field.init
        },
        **_abilities(listed.offer),
    }


def _abilities(offer: "Offer") -> dict[str, Any]:
    from amprep.hookspecs import MeshReader, Packer, VolumeMaker

    if isinstance(offer, MeshReader):
        return {"suffixes": list(offer.suffixes)}
    if isinstance(offer, VolumeMaker):
        return {"makes": offer.makes}
    if isinstance(offer, Packer):
        return {
            "accepts": {
                field.name: _plain(getattr(offer.accepts, field.name)) for field in fields(offer.accepts)
            }
        }
    return {}


def _plain(value: Any) -> Any:
    """Return a value for JSON; sets become sorted lists."""
    if isinstance(value, frozenset | set):
        return sorted(value)
    return value if isinstance(value, bool | int | float | str | list | tuple | dict | None) else str(value)


def _print_offers(host: "Host") -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from amprep.host import KINDS

    table = Table("kind", "name", "description", "from", box=None)
    for kind, description in KINDS.items():
        for each in host.offers(kind).values():
            origin = f"[dim]{each.origin}" if each.builtin else escape(each.origin)
            table.add_row(description.noun, escape(each.offer.name), escape(each.offer.summary), origin)
    Console().print(table)


def _print_trials(trials: "tuple[OfferReport, ...]") -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table("offer", "problem", "", "found", box=None)
    for trial in trials:
        result = "[green]holds" if trial.passed else "[red]broken"
        table.add_row(escape(trial.title), f"{len(trial.problems)} tried", result, ". ".join(trial.notes))
        for violation in trial.violations:
            promise, found = escape(violation.promise), escape(violation.message)
            table.add_row("", escape(violation.subject), f"[red]{promise}", found)
    Console().print(table)
