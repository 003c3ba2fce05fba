"""``amprep printers``: list the printers that a job can name, with the sources of their sizes."""

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from amprep.printers.catalogue import Printer

AsJson = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]

app = typer.Typer(help="List the printers that a job can name, or show one of them.")


@app.callback(invoke_without_command=True)
def _main(context: typer.Context) -> None:
    """List the printers if no command is given."""
    if context.invoked_subcommand is None:
        list_all()


@app.command("list")
def list_all(as_json: AsJson = False) -> None:
    """List all printers with their build volumes and the sources of their sizes."""
    from amprep.printers.catalogue import list_printers

    printers, warnings = list_printers()
    for warning in warnings:
        typer.echo(f"amprep: warning: {warning}", err=True)
    if as_json:
        typer.echo(json.dumps([_record(printer) for printer in printers], indent=2))
    else:
        _print_table(printers)


@app.command("show")
def show(
    name: Annotated[
        str, typer.Argument(metavar="PRINTER", help="Name of a printer, or path of a profile (.toml).")
    ],
    as_json: AsJson = False,
) -> None:
    """Show one printer as a profile that can be saved to a file and changed."""
    from amprep.printers.catalogue import find_printer

    printer = find_printer(name)
    if as_json:
        typer.echo(json.dumps(_record(printer), indent=2))
        return
    for key, value in _record(printer).items():
        if key != "origin" and value is not None:
            typer.echo(f"{key} = {json.dumps(value, ensure_ascii=False)}")


def _record(printer: "Printer") -> dict[str, Any]:
    space = printer.space
    size = space.size.tolist() if space.shape == "box" else space.size.tolist()[1:]
    zones = [[*lo, *hi] for lo, hi in zip(space.zone_lo.tolist(), space.zone_hi.tolist(), strict=True)]
    return {
        "name": printer.name,
        "technology": printer.technology,
        "shape": space.shape,
        "size_mm": size,
        "zones": zones,
        "recoater_deg": printer.recoater_deg,
        "gas_flow_deg": printer.gas_flow_deg,
        "source": printer.source,
        "origin": printer.origin,
    }


def _print_table(printers: "list[Printer]") -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from amprep.printers.catalogue import DEFAULT_PRINTER
    from amprep.profiles import normalised

    table = Table("name", "build volume (mm)", "technology", "source", box=None)
    for printer in printers:
        default = " [dim](default)" if normalised(printer.name) == normalised(DEFAULT_PRINTER) else ""
        origin = "" if printer.origin == "built-in" else f"[dim]{printer.origin}[/] "
        source = origin + escape(printer.source)
        table.add_row(escape(printer.name) + default, _size(printer), printer.technology, source)
    Console().print(table)


def _size(printer: "Printer") -> str:
    x, y, z = (f"{value:g}" for value in printer.space.size.tolist())
    zones = len(printer.space.zone_lo)
    shape = f"{x} x {y} x {z}" if printer.space.shape == "box" else f"diameter {x}, height {z}"
    return shape + (f", {zones} forbidden zone{'s' if zones > 1 else ''}" if zones else "")
