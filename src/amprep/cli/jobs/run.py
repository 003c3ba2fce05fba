"""``amprep run``: pack, support and write build jobs."""

from typing import Annotated

import typer

from amprep.cli.jobs.reporting import build_and_report
from amprep.cli.options import BuildOptions, Packer, job_option, with_options


@with_options(BuildOptions)
def run(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="INPUT",
            help="A job file (.toml), or 3MF files, mesh files and folders; NAME:4 prints four copies.",
            show_default=False,
        ),
    ],
    packer: Packer = None,
    volumes: Annotated[
        str | None,
        job_option(
            "--volumes",
            metavar="NAME",
            help="Volume maker by name, or several as A,B: B bounds the solid that A makes; see 'amprep plugins list'.",
        ),
    ] = None,
    effort: Annotated[
        str | None,
        job_option("--effort", metavar="LEVEL", help="How long the packer works: fast, normal or thorough."),
    ] = None,
    *,
    options: BuildOptions,
) -> None:
    """Pack parts, plan their supports and write build jobs, one 3MF file per printing run.

    For example: amprep run bracket.stl:4 parts/ --printer "Prusa MK4"

    It writes NAME.build-1.3mf and so on, NAME.report.html with a 3D view,
    NAME.report.json, and a picture of each build.

    Exit codes: 0 if done, 1 if something is unplaced, unsupported, locked
    although that is forbidden, or fails verification, 2 for wrong input
    (nothing written), 130 or 143 if Ctrl-C or SIGTERM ended it (nothing written).
    """
    named = None if volumes is None else [name.strip() for name in volumes.split(",")]
    changes = {"packing.strategy": packer, "packing.volumes": named, "packing.effort": effort}
    build_and_report("run", inputs, options, changes)
