"""``amprep slice``: write the contours of a build, layer by layer."""

import json
from pathlib import Path
from typing import Annotated, Literal

import typer

from amprep.cli.log import logging_to
from amprep.cli.options import Debug, LogFile, ProgressForm, Quiet, ResultAsJson, output_option


def slice_(
    file: Annotated[
        Path, typer.Argument(metavar="BUILD.3mf", help="A build file that amprep wrote.", show_default=False)
    ],
    layer: Annotated[
        float, typer.Option(metavar="MM", min=0.0, help="Thickness of a layer.", show_default=False)
    ],
    form: Annotated[
        Literal["cli", "cli-binary", "svg", "3mf-slice"],
        typer.Option(
            "--as",
            metavar="FORMAT",
            help="Format: cli or cli-binary (Common Layer Interface), svg (at most 100 layers) or 3mf-slice.",
        ),
    ] = "cli",
    output: Annotated[
        Path | None,
        output_option(
            "-o", "--output", metavar="FOLDER", help="Output folder; default: the folder of the build file."
        ),
    ] = None,
    time_limit: Annotated[
        float | None,
        typer.Option(
            "--time-limit", min=0.0, metavar="SECONDS", help="Give up after this time and write nothing."
        ),
    ] = None,
    as_json: ResultAsJson = False,
    quiet: Quiet = False,
    progress: ProgressForm = "bars",
    log: LogFile = None,
    debug: Debug = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Write the contours of a build, layer by layer.

    Layers begin at the plate, and each is cut in its middle. Outer contours
    are counter-clockwise, holes clockwise; overlapping shells of a part are
    united, and walls without thickness become open lines. Parts and supports
    are apart: in two files (cli), or as objects or paths of their own.

    Exit codes: 0 if done, 2 for wrong input or if the time is over (nothing
    written), 130 or 143 if Ctrl-C or SIGTERM ended it (nothing written).
    """
    from rich.console import Console

    from amprep.cli.progress import Bars, Lines

    console = Console(stderr=True, quiet=quiet or progress == "lines")
    with (
        logging_to(log) as note,
        Lines(note) if progress == "lines" and not quiet else Bars(console, note) as bars,
        bars.stage("slices") as show,
    ):
        from amprep import api

        record = api.slice_build(
            file, layer, form, output=output or file.parent, time_limit_s=time_limit, progress=show
        )

    from amprep.report.slices.json_form import to_json
    from amprep.report.slices.terminal import summary

    if as_json:
        typer.echo(json.dumps(to_json(record), indent=2))
    elif not quiet:
        Console().print(summary(record))
