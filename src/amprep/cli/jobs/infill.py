"""``amprep lattice``: fill marked regions of parts with lattice cells."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from amprep.cli.jobs.reporting import call_api, finish, output_options
from amprep.cli.options import JobOptions, with_options


@dataclass(frozen=True, kw_only=True)
class FillOptions(JobOptions):
    """The shared options; the output may also be a file."""

    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="PATH",
            help="Output folder or file (.3mf); default: the folder of the first input.",
            rich_help_panel="Output",
        ),
    ] = None


@with_options(FillOptions)
def lattice(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE",
            help="3MF files whose parts have modifiers, mesh files with --region or --shell, or a job file (.toml).",
            show_default=False,
        ),
    ],
    region: Annotated[
        list[Path] | None,
        typer.Option(
            "--region",
            metavar="MESH",
            help="Mesh file of a region, in the coordinates of the input; repeatable.",
        ),
    ] = None,
    region_name: Annotated[
        list[str] | None,
        typer.Option("--region-name", metavar="NAME", help="Fill only the region of this name; repeatable."),
    ] = None,
    shell: Annotated[
        float | None,
        typer.Option("--shell", metavar="MM", help="Fill everything deeper than this below the surface."),
    ] = None,
    size: Annotated[
        float | None,
        typer.Option("--size", metavar="MM", help="Size of a cell; default 5, less in small regions."),
    ] = None,
    height: Annotated[
        float | None, typer.Option("--height", metavar="MM", help="Height of a cell; default: its size.")
    ] = None,
    *,
    options: FillOptions,
) -> None:
    """Fill marked regions of parts with lattice cells.

    The cells of a region and the solid around it become one mesh.

    A region is a modifier of the part in a 3MF file (PrusaSlicer, OrcaSlicer,
    Bambu Studio, Cura), a mesh given by --region, or, with --shell, the whole
    inside of the part below a wall of that thickness.

    It writes NAME.lattice.3mf, which 'amprep run' and slicers read,
    NAME.lattice.report.json, and a picture of the parts cut open.

    Exit codes: 0 if done, 1 if the result fails verification, 2 for wrong
    input (nothing written), 130 or 143 if Ctrl-C or SIGTERM ended it (nothing
    written).
    """
    record = call_api(
        "fill_parts",
        inputs,
        options,
        {},
        **output_options(inputs, options),
        region_files=region or (),
        regions=region_name or (),
        shell_mm=shell,
        size_mm=size,
        height_mm=height,
    )

    from amprep.report.infill import summary, to_json

    finish(record, to_json, summary, options)
