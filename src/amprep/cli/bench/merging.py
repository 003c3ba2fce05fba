"""``amprep bench merging``: cells become one mesh, beside manifold3d's batch union."""

import json
from typing import Annotated

import typer

from amprep import cli


def merging(
    cells: Annotated[int, typer.Option("--cells", metavar="N", min=2, help="How many cells.")] = 100_000,
    sample: Annotated[
        int, typer.Option("--sample", metavar="N", min=2, help="How many manifold3d unites as well.")
    ] = 4096,
    oblique: Annotated[
        float, typer.Option("--oblique", metavar="SHARE", min=0.0, max=0.5, help="Share that leads sideways.")
    ] = 0.12,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the layout.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Merge random cells of 200 triangles; a sample goes through manifold3d's batch union too."""
    from amprep.bench.merging import run_merging

    result = run_merging(cells, sample, oblique=oblique, seed=seed)
    typer.echo(
        json.dumps({"benchmark": "merging", "results": [result.record]}, indent=2) if as_json else result.line
    )
    raise typer.Exit(cli.DONE if result.validated else cli.INCOMPLETE)
