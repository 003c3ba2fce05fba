"""``amprep bench collision``: time collision queries of OBB trees, convex pieces and other packages."""

from pathlib import Path
from typing import Annotated

import typer

from amprep.cli.bench.options import AsJson, Seed, finish, print_json
from amprep.errors import InputError


def collision(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="FILE", help="Mesh files; the first and the last part are used. Default: two made parts."
        ),
    ] = None,
    poses: Annotated[int, typer.Option("--poses", metavar="N", min=1, help="Number of poses.")] = 1000,
    margin: Annotated[
        float, typer.Option("--margin", metavar="MM", min=0.0, help="Clearance below which parts collide.")
    ] = 0.0,
    spread: Annotated[
        float,
        typer.Option("--spread", metavar="MM", min=0.0, help="Greatest distance of a pose from contact."),
    ] = 1.0,
    triangles: Annotated[
        int, typer.Option("--triangles", metavar="N", min=500, help="Triangles of a made part.")
    ] = 20_000,
    pieces: Annotated[bool, typer.Option("--pieces/--no-pieces", help="Time convex pieces as well.")] = True,
    rivals: Annotated[
        bool, typer.Option("--rivals/--no-rivals", help="Time other packages that are installed as well.")
    ] = True,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Time collision queries on two parts in near contact.

    All engines answer at the same poses. The answers are compared, and those
    of the OBB trees are checked independently; the exit code is 1 if an answer
    is wrong.
    """
    from amprep.bench.collision.run import run_collision
    from amprep.bench.collision.scene import made_parts, near_contact
    from amprep.bench.support_volume import meshes_of
    from amprep.host import Host

    parts = meshes_of(files, Host.load()) if files else made_parts(triangles)
    if not parts:
        raise InputError("bench collision needs at least one part; the files contain none")
    scene = near_contact(parts, poses, margin=margin, spread=spread, seed=seed)
    counts = [len(mesh.triangles) for mesh in (scene.moving, scene.other)]
    results = []
    if not as_json:
        typer.echo(
            f"{scene.names[0]} ({counts[0]} triangles) beside {scene.names[1]} ({counts[1]} triangles)"
        )
    for result in run_collision(scene, margin=margin, pieces=pieces, rivals=rivals):
        results.append(result)
        if not as_json:
            typer.echo(result.line)
    if as_json:
        record = {"benchmark": "collision", "parts": scene.names, "triangles": counts, "margin_mm": margin}
        print_json(record | {"results": [each.record for each in results]})
    finish(valid=all(each.validated is not False for each in results))
