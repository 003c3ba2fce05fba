"""``amprep cells``: list the available lattice cells, and check one by itself."""

import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from amprep import cli
from amprep.cli.options import AsJson, supervise_plugins

if TYPE_CHECKING:
    from amprep.pipeline.check_cell import CellReport
    from amprep.pipeline.resolve import ChosenCell

Modules = Annotated[
    list[str] | None,
    typer.Option(
        "-p", "--plugin", metavar="MODULE", help="Load a plugin module too; no:NAME blocks a plugin."
    ),
]

app = typer.Typer(no_args_is_help=True, help="List the available lattice cells, or check one by itself.")


@app.command("list")
def list_all(as_json: AsJson = False, modules: Modules = None) -> None:
    """List every lattice cell with its kind, its parameters and the plugin that provides it."""
    supervise_plugins(modules)
    from amprep.host import Host
    from amprep.pipeline.resolve import cell_named

    host = Host.load(modules=modules or [])
    rows = [_row(cell_named(host, name)) for name in host.offers("cell")]
    for warning in host.warnings:
        typer.echo(f"amprep: warning: {warning}", err=True)
    if as_json:
        typer.echo(json.dumps(rows, indent=2))
    else:
        _print_cells(rows)


@app.command("check")
def check(
    cell: Annotated[
        str, typer.Argument(metavar="CELL", help="Name of a cell, or path of a TOML, STL, OBJ or 3MF file.")
    ],
    sets: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set a parameter of the cell.")
    ] = None,
    pitch: Annotated[float, typer.Option("--pitch", metavar="MM", help="Horizontal size of a cell.")] = 2.0,
    strut_angle: Annotated[
        float, typer.Option("--strut-angle", metavar="DEG", help="Angle of oblique cells to the horizontal.")
    ] = 45.0,
    angle: Annotated[
        float | None,
        typer.Option(
            metavar="DEG", help="Smallest allowed angle of struts and faces to the horizontal; default 30."
        ),
    ] = None,
    feature: Annotated[
        float | None,
        typer.Option(metavar="MM", help="Smallest feature that the machine can print; default 0.15."),
    ] = None,
    hole: Annotated[
        float | None,
        typer.Option(metavar="MM", help="Smallest hole through which powder escapes; default 0.2."),
    ] = None,
    picture: Annotated[Path | None, typer.Option(metavar="PNG", help="Write a picture to this file.")] = None,
    as_json: AsJson = False,
    modules: Modules = None,
) -> None:
    """Check that a lattice cell is closed, stays in the unit cube, joins its neighbours and can be printed.

    The check makes a block of upright cells and columns of oblique cells. The
    limits that the cell promises (least_angle_deg, smallest_feature_mm) apply
    unless an option replaces them.

    Exit codes: 0 if every promise holds, 1 if one is broken, 2 if the cell
    does not exist or cannot be made in this grid.
    """
    supervise_plugins(modules)
    from amprep.host import Host
    from amprep.pipeline.check_cell import check_cell
    from amprep.pipeline.resolve import cell_named

    chosen = cell_named(Host.load(modules=modules or []), cell, sets or [])
    report = check_cell(
        chosen, pitch=pitch, strut_angle_deg=strut_angle, angle_deg=angle, feature=feature, hole=hole
    )
    if picture is not None:
        from amprep.report.cell_picture import draw_cell

        draw_cell(chosen.emit, picture, pitch=pitch, strut_angle_deg=strut_angle)
    if as_json:
        typer.echo(json.dumps(_record(report), indent=2))
    else:
        _print_report(report, picture)
    raise typer.Exit(cli.INCOMPLETE if report.violations else cli.DONE)


def _row(cell: "ChosenCell") -> dict[str, Any]:
    listed, params = cell.listed, cell.params
    declared = cell.declared(2.0, 2.0)
    return {
        "name": cell.name,
        "kinds": list(declared.kinds) if declared else ["code"],
        "summary": listed.offer.summary,
        "origin": listed.origin,
        "builtin": listed.builtin,
        "author": declared.author if declared else "",
        "licence": declared.licence if declared else "",
        "params": {field.name: getattr(params, field.name) for field in fields(params) if field.init},
    }


def _record(report: "CellReport") -> dict[str, Any]:
    return {
        **vars(report),
        "limits": report.limits._asdict(),
        "measures": report.measures._asdict(),
        "violations": [asdict(violation) for violation in report.violations],
    }


def _print_cells(rows: list[dict[str, Any]]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table("name", "kind", "description", "from", box=None)
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
    table.add_row("cell", f"{escape(report.name)} ({', '.join(report.kinds)}) from {escape(report.origin)}")
    if report.author or report.licence:
        table.add_row("author, licence", escape(f"{report.author or '-'}, {report.licence or '-'}"))
    table.add_row("grid", f"pitch {report.pitch:g} mm, step {report.step:.4g} mm")
    table.add_row("templates", f"{report.templates}, with at most {report.triangles} triangles")
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
    return "none to measure" if value is None else f"{value:.2g} mm, limit {least:g} mm"
