"""``amprep bench supports``: support routers on generated scenes, thesis seconds beside ours."""

import json
from enum import StrEnum
from itertools import product
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


class Escalate(StrEnum):
    """What gives way when capacities leave red squares out."""

    NONE = "none"
    CUT = "cut"
    UNIFORM = "uniform"


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
    escalate: Annotated[
        Escalate,
        typer.Option(
            "--escalate", help="What gives way when not all can be connected: nothing, a minimum cut, or all."
        ),
    ] = Escalate.NONE,
    rivals: Annotated[
        bool, typer.Option("--rivals", help="Run OR-tools, scipy and networkx on the same scenes.")
    ] = False,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the router's random numbers.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Route the supports of generated scenes (thesis chapter 4); the judge looks at every plan."""
    from amprep.bench.routing.run import run_scene

    results = []
    for size, scene in product(sizes, scenes or list(Scene)):
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
        typer.echo(
            json.dumps({"benchmark": "supports", "results": [each.record for each in results]}, indent=2)
        )
    raise typer.Exit(cli.DONE if all(each.validated is not False for each in results) else cli.INCOMPLETE)
