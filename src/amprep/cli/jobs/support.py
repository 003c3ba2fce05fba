"""``amprep support``: plan supports for parts at the positions in their files."""

from typing import Annotated

import typer

from amprep.cli.jobs.reporting import build_and_report, explain_and_report
from amprep.cli.options import BuildOptions, with_options


@with_options(BuildOptions)
def support(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE",
            help="A job file (.toml), or 3MF files and mesh files.",
            show_default=False,
        ),
    ],
    center: Annotated[
        bool, typer.Option("--center", help="First move all parts together to the middle of the plate.")
    ] = False,
    grounding: Annotated[
        str | None,
        typer.Option(
            metavar="WHERE",
            help="Where supports may stand: plate-only, or anywhere (on parts, if the plate cannot be reached).",
            rich_help_panel="Settings of the job",
        ),
    ] = None,
    explain: Annotated[
        str | None,
        typer.Option(
            metavar="PART",
            help="List the overhang regions of a part (* and ? as in file names), with their verdicts and the number "
            "of the job's rule that takes each; plan and write nothing.",
        ),
    ] = None,
    *,
    options: BuildOptions,
) -> None:
    """Plan supports for parts at the positions in their files; nothing is packed.

    Parts of a 3MF file stay at the positions of its build items, other meshes
    at their own coordinates. Every part must be in the build volume; the plate
    is at z = 0.

    It writes NAME.supported.3mf, NAME.supported.report.html with a 3D view,
    NAME.supported.report.json, and a picture.

    Exit codes: 0 if done, 1 if something is unsupported or fails verification,
    2 for wrong input (nothing written), 130 or 143 if Ctrl-C or SIGTERM ended
    it (nothing written).
    """
    if explain is not None:
        explain_and_report(inputs, explain, options, center=center)
    build_and_report("support", inputs, options, {"supports.grounding": grounding}, center=center)
