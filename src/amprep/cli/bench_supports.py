"""``amprep bench supports``: support routers on generated scenes, thesis seconds beside ours."""

import json
from enum import StrEnum
from typing import Annotated

import typer

from amprep import cli


class Size(StrEnum):
    """The thesis's sizes, about 8,400 to 6.5 million squares."""

    A = "A"
    B = "B"
    C = "C"
    D = "D"
    E = "E"


class Scene(StrEnum):
    """The generated scenes."""

    BALL = "ball"
    TWO_BALLS = "two-balls"
    PLATE = "plate"


def supports(
    sizes: Annotated[
        list[Size], typer.Option("--size", case_sensitive=False, help="Size of the grid; repeatable.")
    ],
    scenes: Annotated[
        list[Scene] | None, typer.Option("--scene", help="Scene; repeatable, default all.")
    ] = None,
    routers: Annotated[
        list[str] | None,
        typer.Option(
            "--router", metavar="NAME", help="Router; repeatable, default push-relabel and min-cost-flow."
        ),
    ] = None,
    capacity: Annotated[
        int, typer.Option("--capacity", metavar="C", min=0, help="Paths a square holds; 0: any number.")
    ] = 0,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the router's random numbers.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Route the supports of generated scenes (thesis chapter 4); the judge looks at every plan."""
    from amprep.pipeline.bench_supports import run_scene

    results = []
    for size in sizes:
        for scene in scenes or list(Scene):
            for router in routers or ["push-relabel", "min-cost-flow"]:
                results.append(run_scene(router, scene.value, size.value, capacity=capacity, seed=seed))
                if not as_json:
                    typer.echo(results[-1].line)
    if as_json:
        typer.echo(
            json.dumps({"benchmark": "supports", "results": [each.record for each in results]}, indent=2)
        )
    raise typer.Exit(cli.DONE if all(each.validated for each in results) else cli.INCOMPLETE)
