"""``amprep bench support-volume``: how much support, against straight columns and PrusaSlicer."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from amprep.bench.support_volume import VolumeResult


def support_volume(
    files: Annotated[
        list[Path] | None, typer.Argument(help="Mesh files to support too, each part standing on the plate.")
    ] = None,
    routers: Annotated[
        list[str] | None,
        typer.Option("--router", metavar="NAME", help="Router; repeatable, default shortest-paths."),
    ] = None,
    cell: Annotated[str, typer.Option("--cell", metavar="NAME", help="Lattice cell.")] = "x-wall",
    pitch: Annotated[float, typer.Option("--pitch", metavar="MM", min=0.1, help="Grid pitch.")] = 2.0,
    generated: Annotated[bool, typer.Option(help="Also support the generated parts.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Compare the volume of supports with straight columns of the same contact.

    Every red square with nothing below it is held: once as amprep plans it, once by a straight column of the same
    cells. Where PrusaSlicer is installed, the support in its G-code stands beside.
    """
    from amprep.bench.support_volume import compare, find_slicer, generated_parts, meshes_of
    from amprep.host import Host
    from amprep.model import Stop

    host = Host.load()
    slicer = find_slicer()
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
        typer.echo(json.dumps(record | {"results": [each.record for each in results]}, indent=2))


def _line(result: "VolumeResult") -> str:
    ours = ", ".join(
        f"{name} {volume / 1000:.3f} ({volume / result.straight:.0%} of straight)"
        for name, volume in result.routers.items()
    )
    rivals = ", ".join(
        f"{style} {'-' if volume is None else f'{volume / 1000:.3f}'}"
        for style, volume in result.rivals.items()
    )
    return (
        f"{result.part}: contact {result.contact_mm2:.0f} mm2; cm3: {ours}; straight {result.straight / 1000:.3f}; "
        f"PrusaSlicer {rivals}"
    )
