"""``amprep materials``: list the materials that a job can name, with their limits and the sources of these."""

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from amprep.cli.printers import AsJson

if TYPE_CHECKING:
    from amprep.materials.catalogue import Material

app = typer.Typer(help="List the materials that a job can name, or show one of them.")


@app.callback(invoke_without_command=True)
def _main(context: typer.Context) -> None:
    """List the materials if no command is given."""
    if context.invoked_subcommand is None:
        list_all()


@app.command("list")
def list_all(as_json: AsJson = False) -> None:
    """List all materials with their limits for overhangs, density, layer height and speed."""
    from amprep.materials.catalogue import list_materials

    materials, warnings = list_materials()
    for warning in warnings:
        typer.echo(f"amprep: warning: {warning}", err=True)
    if as_json:
        typer.echo(json.dumps([_record(material) for material in materials], indent=2))
    else:
        _print_table(materials)


@app.command("show")
def show(
    name: Annotated[
        str, typer.Argument(metavar="MATERIAL", help="Name of a material, or path of a profile (.toml).")
    ],
    as_json: AsJson = False,
) -> None:
    """Show one material as a profile that can be saved to a file and changed."""
    from amprep.materials.catalogue import material_called

    record = _record(material_called(name))
    if as_json:
        typer.echo(json.dumps(record, indent=2))
        return
    for key, value in record.items():
        if key not in ("origin", "based_on") and value is not None:  # every key is stated
            typer.echo(f"{key} = {json.dumps(value, ensure_ascii=False)}")


def _record(material: "Material") -> dict[str, Any]:
    values = asdict(material.profile)
    first = ("name", "aliases", "based_on", "density_g_cm3")
    return {**{key: values[key] for key in first}, **values, "origin": material.origin}


def _print_table(materials: "list[Material]") -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from amprep.materials.catalogue import DEFAULT_MATERIALS

    table = Table(box=None)
    table.add_column("name", no_wrap=True)
    for heading in ("g/cm3", "ledge mm", "bridge mm", "bore mm", "layer mm", "mm2/s"):
        table.add_column(heading, justify="right", no_wrap=True)
    sources = Table(box=None, show_header=False)
    sources.add_column(no_wrap=True)
    for material in materials:
        profile = material.profile
        default = " [dim](default)" if profile.name in DEFAULT_MATERIALS.values() else ""
        origin = "" if material.origin == "built-in" else f"[dim]{material.origin}[/] "
        table.add_row(
            escape(profile.name) + default,
            "-" if profile.density_g_cm3 is None else f"{profile.density_g_cm3:g}",
            *map(_limit, (profile.ledge_mm, profile.bridge_mm, profile.bore_mm)),
            f"{profile.layer_mm:g}",
            f"{profile.scan_mm2_s:g}",
        )
        sources.add_row(escape(profile.name), origin + escape(profile.source))
    Console().print(table, "", "Sources:", sources)


def _limit(value: float) -> str:
    from amprep.model.supports.rules import LARGEST_LIMIT

    return "any" if value >= LARGEST_LIMIT else f"{value:g}"
