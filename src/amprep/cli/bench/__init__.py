"""``amprep bench``: rerun published benchmarks; every answer is judged anew."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from amprep import cli
from amprep.cli.bench.merging import merging
from amprep.cli.bench.routing import supports
from amprep.cli.bench.support_volume import support_volume
from amprep.errors import InputError

if TYPE_CHECKING:
    from amprep.bench.packing.run import Result
    from amprep.bench.packing.thesis_tables import Table

app = typer.Typer(
    no_args_is_help=True, help="Benchmarks: rerun published instances; every answer is judged anew."
)
app.command("merging")(merging)
app.command("supports")(supports)
app.command("support-volume")(support_volume)

TimeLimit = Annotated[float, typer.Option("--time-limit", metavar="S", min=0.0, help="Seconds an instance.")]
PackerName = Annotated[str, typer.Option("--packer", metavar="NAME", help="Packer to run.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of the packer's random numbers.")]
First = Annotated[int, typer.Option("--first", min=1, help="First instance, from 1.")]
Count = Annotated[int, typer.Option("--count", min=1, help="Number of instances.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]


@app.command("mpv")
def mpv(
    class_: Annotated[int, typer.Option("--class", metavar="C", min=1, max=8, help="Class, 1 to 8.")],
    n: Annotated[int, typer.Option("--n", metavar="N", min=1, help="Boxes, usually 50, 100, 150 or 200.")],
    time_limit: TimeLimit = 10.0,
    packer: PackerName = "auto",
    first: First = 1,
    count: Count = 10,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Pack the instances of Martello, Pisinger and Vigo (2000) into as few builds as possible."""
    from amprep.bench.packing.instances import mpv_instance
    from amprep.bench.packing.run import run_instances

    instances = [mpv_instance(class_, n, index) for index in range(first, first + count)]
    results = run_instances(instances, packer, seconds=time_limit, seed=seed, progress=_tell(as_json))
    record = {"benchmark": "mpv", "class": class_, "n": n, "packer": packer, "time_limit_s": time_limit}
    _print(record, results, as_json=as_json)


@app.command("container-loading")
def container_loading(
    file: Annotated[Path, typer.Argument(help="JSON file of instances: container, boxes, rotation flags.")],
    time_limit: TimeLimit = 30.0,
    packer: PackerName = "auto",
    first: First = 1,
    count: Annotated[int, typer.Option("--count", min=0, help="Number of instances; 0: all.")] = 0,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Fill one container as full as possible, instance by instance."""
    from amprep.bench.packing.container_loading import read_loading
    from amprep.bench.packing.run import run_instances

    known = read_loading(file)
    if first > len(known):
        raise InputError(f"{file}: expected --first of at most {len(known)}, its instances; got {first}")
    instances = known[first - 1 : first - 1 + count if count else None]
    results = run_instances(instances, packer, seconds=time_limit, seed=seed, progress=_tell(as_json))
    record = {
        "benchmark": "container-loading",
        "file": file.name,
        "packer": packer,
        "time_limit_s": time_limit,
    }
    _print(record, results, as_json=as_json)


@app.command("packing")
def packing(
    time_limit: TimeLimit = 5.0,
    packers: Annotated[
        list[str] | None, typer.Option("--packer", metavar="NAME", help="Only this packer; repeatable.")
    ] = None,
    most_boxes: Annotated[int, typer.Option("--most-boxes", min=15, help="Leave larger columns out.")] = 120,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Rerun the thesis's two packing tables on instances of the same shape, its columns beside ours."""
    from amprep.bench.packing.thesis_tables import thesis_tables

    progress = (lambda _: None) if as_json else (lambda line: typer.echo(line, err=True))
    tables = thesis_tables(packers or [], most_boxes, seconds=time_limit, seed=seed, progress=progress)
    if as_json:
        typer.echo(json.dumps([_table_record(table) for table in tables], indent=2))
    else:
        for table in tables:
            _print_table(table)
    valid = all(result.validated for table in tables for row in table.ours.values() for result in row)
    raise typer.Exit(cli.DONE if valid else cli.INCOMPLETE)


def _table_record(table: "Table") -> dict[str, Any]:
    ours = {label: [result.record for result in row] for label, row in table.ours.items()}
    return {"table": table.title, "boxes": table.boxes, "thesis": table.thesis, "instances": ours}


def _print_table(table: "Table") -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table as Grid

    from amprep.bench.packing.thesis_tables import cell

    grid = Grid("boxes", *map(str, table.boxes), box=box.SIMPLE, title=table.title)
    for name, cells in table.thesis.items():
        grid.add_row(f"thesis: {name}", *cells, style="dim")
    for label, row in table.ours.items():
        grid.add_row(label, *(cell(result) if result.validated else "INVALID" for result in row))
    Console().print(grid)


def _tell(as_json: bool) -> "Callable[[Result], None]":
    """Return what prints a result as soon as it is there."""
    return (lambda _: None) if as_json else (lambda result: typer.echo(result.line))


def _print(record: dict[str, Any], results: "list[Result]", *, as_json: bool) -> None:
    """Print the means, or all as JSON; exit code 1 when an answer does not stand up to the judge."""
    from amprep.bench.packing.run import means

    record |= {"mean": means(results), "instances": [result.record for result in results]}
    if as_json:
        typer.echo(json.dumps(record, indent=2))
    else:
        typer.echo("mean " + ", ".join(f"{name} {value:.6g}" for name, value in record["mean"].items()))
    raise typer.Exit(cli.DONE if all(result.validated for result in results) else cli.INCOMPLETE)
