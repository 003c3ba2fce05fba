"""``amprep bench supports``: run support routers on generated scenes, next to the thesis's times."""

from enum import StrEnum
from itertools import product
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from amprep.cli.bench.options import AsJson, Seed, finish, print_json
from amprep.errors import InputError

if TYPE_CHECKING:
    from amprep.bench.routing.thesis_table import InputResults

SceneSize = StrEnum("SceneSize", {"A": "A", "B": "B", "C": "C", "D": "D", "E": "E"})
"""Sizes of the thesis, from about 8,400 to 6.5 million squares."""

SceneName = StrEnum("SceneName", {"BALL": "ball", "TWO_BALLS": "two-balls", "PLATE": "plate"})

Raising = StrEnum("Raising", {"NONE": "none", "CUT": "cut", "UNIFORM": "uniform"})
"""Rule by which capacities are raised."""


def supports(
    inputs: Annotated[
        list[SceneSize] | None,
        typer.Option(
            "--input",
            case_sensitive=False,
            help="Input of the thesis's table; repeatable. Default: all, A to E.",
        ),
    ] = None,
    sizes: Annotated[
        list[SceneSize] | None,
        typer.Option(
            "--size",
            case_sensitive=False,
            help="Route generated parts instead, on grids of the size of inputs A to E; repeatable.",
        ),
    ] = None,
    scenes: Annotated[
        list[SceneName] | None,
        typer.Option("--scene", help="Generated part, with --size; repeatable. Default: all."),
    ] = None,
    routers: Annotated[
        list[str] | None,
        typer.Option(
            "--router",
            metavar="NAME",
            help="Router; repeatable. Default: the thesis's three; with --size without shortest-paths.",
        ),
    ] = None,
    capacity: Annotated[
        int | None,
        typer.Option(
            "--capacity",
            metavar="N",
            min=0,
            help="Largest number of paths through a square; 0: no limit. Default: 4; with --size no limit.",
        ),
    ] = None,
    escalate: Annotated[
        Raising,
        typer.Option(
            "--escalate",
            help="Capacities to raise if some overhangs cannot be connected: none, those of a minimum cut, or all.",
        ),
    ] = Raising.NONE,
    rivals: Annotated[
        bool, typer.Option("--rivals", help="Also run OR-tools, scipy and networkx on the same scenes.")
    ] = False,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Print the thesis's table of support planning (chapter 4) on inputs of the same sizes, or route generated parts.

    Each plan is checked independently. The exit code is 1 if a plan is invalid.
    """
    if not sizes:
        for option, given in (
            ("--scene", scenes),
            ("--escalate", escalate != Raising.NONE),
            ("--rivals", rivals),
        ):
            if given:
                raise InputError(f"{option} needs --size; the thesis's table has inputs of its own")
        letters = [each.value for each in inputs or list(SceneSize)]
        _table(letters, routers, 4 if capacity is None else capacity, seed, as_json=as_json)
    if inputs:
        raise InputError("--input and --size exclude each other; give one of them")
    from amprep.bench.routing.run import run_scene

    results = []
    for size, scene in product(sizes or (), scenes or list(SceneName)):
        for result in run_scene(
            routers or ["push-relabel", "min-cost-flow"],
            scene.value,
            size.value,
            capacity=capacity or 0,
            seed=seed,
            escalation=escalate.value,
            rivals=rivals,
        ):
            results.append(result)
            if not as_json:
                typer.echo(result.line)
    if as_json:
        print_json({"benchmark": "supports", "results": [each.record for each in results]})
    finish(valid=all(each.validated is not False for each in results))


def _table(
    inputs: list[str], routers: list[str] | None, capacity: int, seed: int, *, as_json: bool
) -> NoReturn:
    """Run the routers on inputs of the thesis, print the table and end the command."""
    from amprep.bench.routing.thesis_table import ROUTERS, thesis_table

    progress = (lambda _: None) if as_json else (lambda line: typer.echo(line, err=True))
    columns = thesis_table(inputs, routers or ROUTERS, capacity=capacity, seed=seed, progress=progress)
    results = [result for column in columns for result in column.results]
    if as_json:
        print_json({"benchmark": "supports", "results": [each.record for each in results]})
    else:
        _print_table(columns, capacity)
    finish(valid=all(each.validated is not False for each in results))


def _print_table(columns: "list[InputResults]", capacity: int) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from amprep.bench.routing.thesis_table import EDGES, NODES

    limit = f"capacity {capacity}" if capacity else "no capacities"
    shown = Table(
        "input", *(each.name for each in columns), box=box.SIMPLE, title=f"support planning, {limit}"
    )
    shown.add_row("thesis: nodes", *(str(NODES[each.name]) for each in columns), style="dim")
    shown.add_row("nodes", *(str(each.nodes) for each in columns))
    shown.add_row("thesis: edges", *(str(EDGES[each.name]) for each in columns), style="dim")
    shown.add_row("edges", *(str(each.edges) for each in columns))
    shown.add_row("red squares", *(str(each.red_squares) for each in columns))
    for row in zip(*(each.results for each in columns), strict=True):
        thesis = ("" if each.thesis_seconds is None else f"{each.thesis_seconds:g} s" for each in row)
        shown.add_row(f"thesis: {row[0].router}", *thesis, style="dim")
        cells = (f"{each.seconds:.3f} s" if each.validated else "INVALID" for each in row)
        shown.add_row(row[0].router, *cells)
    Console().print(shown)
