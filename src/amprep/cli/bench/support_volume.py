"""``amprep bench support-volume``: compare support volumes with straight columns and PrusaSlicer."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep.cli.bench.options import AsJson, print_json

if TYPE_CHECKING:
    from amprep.bench.support_volume import SupportVolumeResult


def support_volume(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="FILE", help="Mesh files to support as well; each part is moved onto the plate."
        ),
    ] = None,
    routers: Annotated[
        list[str] | None,
        typer.Option("--router", metavar="NAME", help="Router; repeatable. Default: shortest-paths."),
    ] = None,
    cell: Annotated[str, typer.Option("--cell", metavar="NAME", help="Lattice cell.")] = "x-wall",
    pitch: Annotated[float, typer.Option("--pitch", metavar="MM", min=0.1, help="Pitch of the grid.")] = 2.0,
    generated: Annotated[
        bool, typer.Option("--generated/--no-generated", help="Support the generated parts as well.")
    ] = True,
    as_json: AsJson = False,
) -> None:
    """Compare the volume of supports with straight columns of the same contact area.

    Overhangs are supported where a free column leads straight down to the plate.
    If PrusaSlicer is installed, the volume of its own supports is listed as well.
    """
    from amprep.bench.prusaslicer import find_slicer
    from amprep.bench.support_volume import compare, generated_parts, meshes_of
    from amprep.host import Host
    from amprep.model import Stop

    host, slicer = Host.load(), find_slicer()
    parts = {**(generated_parts() if generated else {}), **meshes_of(files or [], host)}
    results = []
    for name, mesh in parts.items():
        results.append(
            compare(
                name,
                mesh,
                host,
                routers=routers or ["shortest-paths"],
                cell=cell,
                pitch=pitch,
                slicer=slicer,
                stop=Stop(),
            )
        )
        if not as_json:
            typer.echo(_line(results[-1]))
    if as_json:
        record = {"benchmark": "support-volume", "cell": cell, "pitch_mm": pitch}
        print_json(record | {"results": [each.record for each in results]})


def _line(result: "SupportVolumeResult") -> str:
    ours = ", ".join(
        f"{name} {volume / 1000:.3f} cm3 ({volume / result.straight:.0%} of straight columns)"
        for name, volume in result.routers.items()
    )
    rivals = ", ".join(
        f"{style} {'none' if volume is None else f'{volume / 1000:.3f} cm3'}"
        for style, volume in result.rivals.items()
    )
    return (
        f"{result.part}: contact {result.contact_mm2:.0f} mm2; {ours}; straight columns "
        f"{result.straight / 1000:.3f} cm3; PrusaSlicer: {rivals}"
    )
