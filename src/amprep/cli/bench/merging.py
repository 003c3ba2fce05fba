"""``amprep bench merging``: unite cells to one mesh and compare with manifold3d's batch union."""

from typing import Annotated

import typer

from amprep.cli.bench.options import AsJson, Seed, finish, print_json


def merging(
    cells: Annotated[int, typer.Option("--cells", metavar="N", min=2, help="Number of cells.")] = 100_000,
    sample: Annotated[
        int,
        typer.Option("--sample", metavar="N", min=2, help="Number of cells that manifold3d unites as well."),
    ] = 4096,
    oblique: Annotated[
        float,
        typer.Option("--oblique", metavar="FRACTION", min=0.0, max=0.5, help="Fraction of oblique cells."),
    ] = 0.12,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Measure how fast cells are united to one mesh.

    The cells have 200 triangles each and are placed at random. The mesh of a
    sample is compared with the batch union of manifold3d; the exit code is 1
    if they differ.
    """
    from amprep.bench.merging import run_merging

    result = run_merging(cells, sample, oblique=oblique, seed=seed)
    if as_json:
        print_json({"benchmark": "merging", "results": [result.record]})
    else:
        typer.echo(result.line)
    finish(valid=result.validated)
