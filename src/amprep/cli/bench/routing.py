"""``amprep bench supports``: run support routers on generated scenes, next to the thesis's times."""

from enum import StrEnum
from itertools import product
from typing import Annotated

import typer

from amprep.cli.bench.options import AsJson, Seed, finish, print_json

SceneSize = StrEnum("SceneSize", {"A": "A", "B": "B", "C": "C", "D": "D", "E": "E"})
"""Sizes of the thesis, from about 8,400 to 6.5 million squares."""

SceneName = StrEnum("SceneName", {"BALL": "ball", "TWO_BALLS": "two-balls", "PLATE": "plate"})

Raising = StrEnum("Raising", {"NONE": "none", "CUT": "cut", "UNIFORM": "uniform"})
"""Rule by which capacities are raised."""


def supports(
    sizes: Annotated[
        list[SceneSize],
        typer.Option(
            "--size",
            case_sensitive=False,
            help="Size of the grid, as inputs A to E of the thesis; repeatable.",
        ),
    ],
    scenes: Annotated[
        list[SceneName] | None, typer.Option("--scene", help="Generated part; repeatable. Default: all.")
    ] = None,
    routers: Annotated[
        list[str] | None,
        typer.Option(
            "--router", metavar="NAME", help="Router; repeatable. Default: push-relabel and min-cost-flow."
        ),
    ] = None,
    capacity: Annotated[
        int,
        typer.Option(
            "--capacity", metavar="N", min=0, help="Largest number of paths through a square; 0: no limit."
        ),
    ] = 0,
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
    """Route the supports of generated scenes (thesis chapter 4).

    Each plan is checked independently. The exit code is 1 if a plan is invalid.
    """
    from amprep.bench.routing.run import run_scene

    results = []
    for size, scene in product(sizes, scenes or list(SceneName)):
        for result in run_scene(
            routers or ["push-relabel", "min-cost-flow"],
            scene.value,
            size.value,
            capacity=capacity,
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
