"""``amprep bench plates``: pack parts on as few plates as possible with several packers, side by side."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep.cli.bench.options import AsJson, Seeds, finish, print_json
from amprep.errors import InputError

if TYPE_CHECKING:
    from amprep.bench.plates.run import PlatesResult

COMPARED = ("plates", "extreme-points")
"""Packers that are compared unless others are named."""


def plates(
    files: Annotated[list[Path], typer.Argument(metavar="PARTS", help="Mesh files, 3MF jobs or folders.")],
    size: Annotated[
        str, typer.Option("--size", metavar="XxY", help="Sides of the plate, mm, for example 250x210.")
    ] = "250x250",
    clearance: Annotated[
        float,
        typer.Option(
            "--clearance", metavar="MM", min=0.0, help="Least distance between parts and to the walls."
        ),
    ] = 2.0,
    rotations: Annotated[
        str, typer.Option("--rotations", metavar="WORD", help="Allowed rotations: none, z90, z15, about-z.")
    ] = "z90",
    packers: Annotated[
        list[str] | None,
        typer.Option("--packer", metavar="NAME", help="Packer to measure; repeatable."),
    ] = None,
    rivals: Annotated[
        bool,
        typer.Option("--rivals", help="Pack the same shadows with the package spyrrow as well."),
    ] = False,
    time_limit: Annotated[
        float,
        typer.Option("--time-limit", metavar="SECONDS", min=0.0, help="Time limit per packer and seed."),
    ] = 90.0,
    seeds: Seeds = 1,
    as_json: AsJson = False,
) -> None:
    """Pack parts on as few plates as possible, without stacking.

    Every plate is checked as polygons and on the meshes; the exit code is 1 if
    a plate is wrong or a part is left.
    """
    from amprep.bench.plates.run import PlatesBench, ratios_to, read_scene

    sides = _sides(size)
    scene = read_scene(files, sides, clearance, rotations)
    results: list[PlatesResult] = []
    for name in packers or _installed():
        bench = PlatesBench(scene, name)
        bench.warm_up()
        results += [bench.run(seed, time_limit) for seed in range(1, seeds + 1)]
    if rivals:
        from amprep.bench.plates.rivals import spyrrow_plates

        results += [spyrrow_plates(scene, seconds=time_limit, seed=seed) for seed in range(1, seeds + 1)]
    ratios = ratios_to("spyrrow", results)
    least = scene.shadow_area / (sides[0] * sides[1])
    if as_json:
        record = {"benchmark": "plates", "parts": scene.copies, "size_mm": sides, "clearance_mm": clearance}
        record |= {"rotations": rotations, "time_limit_s": time_limit, "shadows_in_plates": least}
        record |= {"ratios_to_spyrrow": ratios}
        print_json(record | {"results": [result.record for result in results]})
    else:
        _print(results, f"{scene.copies} parts, shadows of {least:.2f} plates of {size} mm")
        for name, ratio in ratios.items():
            typer.echo(f"plates of {name} over those of spyrrow: {ratio:.2f}")
    finish(valid=all(result.validated for result in results))


def _installed() -> list[str]:
    from amprep.host import Host

    known = Host.load().offers("packer")
    return [name for name in COMPARED if name in known]


def _sides(text: str) -> tuple[float, float]:
    """Return the sides of a plate."""
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*x\s*(\d+(?:\.\d+)?)", text.strip())
    sides = (float(match[1]), float(match[2])) if match else (0.0, 0.0)
    if min(sides) <= 0.0:
        raise InputError(f"--size: expected two lengths in mm such as 250x210, got {text[:40]!r}")
    return sides


def _print(results: "list[PlatesResult]", title: str) -> None:
    """Print a table of the packers, and the first violations."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE, title=title, title_justify="left", pad_edge=False)
    table.add_column("packer", no_wrap=True)
    for heading in ("seed", "plates", "bound", "filled", "s (processor)", "MiB", "checks"):
        table.add_column(heading, justify="right", no_wrap=True)
    for result in results:
        table.add_row(result.packer, *_cells(result))
    Console().print(table)
    for result in results:
        typer.echo(
            f"{result.packer}, seed {result.seed}, checked in {result.check_seconds:.1f} s of processor time: "
            f"distances of polygons, and of meshes ({result.pairs})"
        )
        for fault in result.faults[:5]:
            typer.echo(f"  {fault}")


def _cells(result: "PlatesResult") -> list[str]:
    left = f", {result.unplaced} left" if result.unplaced else ""
    bound = "-" if result.bound is None else f"{result.bound:g} for {result.bound_for}"
    return [
        str(result.seed),
        f"{result.plates}{left}",
        bound,
        f"{result.filled:.1%}",
        f"{result.seconds:.1f} ({result.process_seconds:.1f})",
        str(result.memory_mb),
        "INVALID" if result.faults else "valid",
    ]
