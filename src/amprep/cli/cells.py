"""``amprep cells``: list the lattice cells on offer, and judge one by itself."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from amprep import cli

if TYPE_CHECKING:
    from amprep.hookspecs import CellEmitter
    from amprep.host import Host, Listed
    from amprep.pipeline.check_cell import CellReport

AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]
Modules = Annotated[
    list[str] | None,
    typer.Option("-p", "--plugin", metavar="MODULE", help="Load a plugin module too; no:NAME blocks one."),
]

app = typer.Typer(no_args_is_help=True, help="Lattice cells: list what is on offer, judge one by itself.")


@app.command("list")
def list_all(as_json: AsJson = False, modules: Modules = None) -> None:
    """List every lattice cell with its kind, its parameters and the plugin it comes from."""
    from amprep.host import Host

    host = Host.load(modules=modules or [])
    rows = [_offered(host, host.choose("cell", name)) for name in host.offers("cell")]
    for warning in host.warnings:
        typer.echo(f"amprep: warning: {warning}", err=True)
    if as_json:
        typer.echo(json.dumps(rows, indent=2))
    else:
        _print_cells(rows)


@app.command("check")
def check(
    cell: Annotated[str, typer.Argument(help="Name of a cell, or the path of a file: TOML, STL, OBJ, 3MF.")],
    sets: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="A parameter of the cell.")
    ] = None,
    pitch: Annotated[float, typer.Option("--pitch", metavar="MM", help="Pitch of the grid.")] = 2.0,
    strut_angle: Annotated[
        float, typer.Option("--strut-angle", metavar="DEG", help="Steepness of oblique edges.")
    ] = 45.0,
    angle: Annotated[
        float | None, typer.Option(metavar="DEG", help="Least steepness of struts and faces; default 30.")
    ] = None,
    feature: Annotated[
        float | None, typer.Option(metavar="MM", help="Thinnest the machine prints; default 0.15.")
    ] = None,
    hole: Annotated[
        float | None, typer.Option(metavar="MM", help="Narrowest hole that powder leaves; default 0.2.")
    ] = None,
    picture: Annotated[Path | None, typer.Option(metavar="PNG", help="Draw the cell into this file.")] = None,
    as_json: AsJson = False,
    modules: Modules = None,
) -> None:
    """Judge a lattice cell: closed, in the cube, ports that match, steep, thick and open enough.

    A block of upright edges and columns of oblique ones are made of it. What the cell promises about itself
    (least_angle_deg, smallest_feature_mm) counts unless an option says otherwise. Exit code 0: every promise
    holds; 1: some do not; 2: there is no such cell, or it cannot be made in this grid.
    """
    from amprep.host import Host
    from amprep.pipeline.check_cell import check_cell, limits_of
    from amprep.pipeline.choose_cell import cell_named

    host = Host.load(modules=modules or [])
    listed, table = cell_named(host, cell, sets or [])
    limits = limits_of(
        host,
        listed,
        table,
        pitch=pitch,
        strut_angle_deg=strut_angle,
        angle_deg=angle,
        feature=feature,
        hole=hole,
    )
    report = check_cell(host, listed, table, pitch=pitch, strut_angle_deg=strut_angle, limits=limits)
    if picture is not None:
        from amprep.report.cell_picture import draw_cell

        draw_cell(host, listed, table, picture, pitch=pitch, strut_angle_deg=strut_angle)
    if as_json:
        typer.echo(json.dumps(_record(report), indent=2))
    else:
        _print_report(report, picture)
    raise typer.Exit(cli.INCOMPLETE if report.violations else cli.DONE)


def _offered(host: "Host", listed: "Listed[CellEmitter]") -> dict[str, Any]:
    from dataclasses import fields

    from amprep.pipeline.check_cell import declared_cell

    declared = declared_cell(host, listed)
    defaults = listed.offer.params()
    return {
        "name": listed.offer.name,
        "kinds": list(declared.kinds) if declared else ["code"],
        "summary": listed.offer.summary,
        "origin": listed.origin,
        "builtin": listed.builtin,
        "author": declared.author if declared else "",
        "licence": declared.licence if declared else "",
        "params": {field.name: getattr(defaults, field.name) for field in fields(defaults) if field.init},
    }


def _record(report: "CellReport") -> dict[str, Any]:
    return {
        **{
            key: value
            for key, value in vars(report).items()
            if key not in ("limits", "measures", "violations")
        },
        "limits": report.limits._asdict(),
        "measures": report.measures._asdict(),
        "violations": [asdict(violation) for violation in report.violations],
    }


def _print_cells(rows: list[dict[str, Any]]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table("name", "kind", "what it is", "from", box=None)
    for row in rows:
        origin = f"[dim]{row['origin']}" if row["builtin"] else escape(row["origin"])
        table.add_row(escape(row["name"]), ", ".join(row["kinds"]), escape(row["summary"]), origin)
    Console().print(table)


def _print_report(report: "CellReport", picture: Path | None) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    measures, limits = report.measures, report.limits
    table = Table(box=None, show_header=False)
    table.add_row("cell", f"{escape(report.name)} ({', '.join(report.kinds)}) of {escape(report.origin)}")
    if report.author or report.licence:
        table.add_row("author, licence", escape(f"{report.author or '-'}, {report.licence or '-'}"))
    table.add_row("grid", f"pitch {report.pitch:g} mm, step {report.step:.4g} mm")
    table.add_row("templates", f"{report.templates}, at most {report.triangles} triangles")
    table.add_row("relative density", f"{measures.density:.1%}")
    table.add_row("smallest feature", _length(measures.feature, limits.feature))
    table.add_row("hole for powder", _length(measures.hole, limits.hole))
    for violation in report.violations:
        table.add_row(
            f"[red]{escape(violation.promise)}", escape(f"{violation.subject}: {violation.message}")
        )
    if not report.violations:
        table.add_row("promises", "[green]all hold")
    if picture is not None:
        table.add_row("picture", escape(str(picture)))
    Console().print(table)


def _length(value: float | None, least: float) -> str:
    return "none to measure" if value is None else f"{value:.2g} mm, at least {least:g} mm wanted"
