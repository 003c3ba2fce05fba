"""``amprep orient``: propose orientations in which parts cost little."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from amprep.cli.jobs.reporting import call_api, finish
from amprep.cli.options import (
    Debug,
    LogFile,
    Material,
    NoPlugins,
    Plugins,
    Printer,
    ProgressForm,
    Quiet,
    ReadingOptions,
    ResultAsJson,
    Sets,
    Workers,
    job_option,
    output_option,
    with_options,
)

_FACES = "a colour (#RRGGBB), a marked region, or a direction as drawn (+x, -z); repeatable."


@dataclass(frozen=True, kw_only=True)
class OrientationOptions(ReadingOptions):
    """Options of the command that do not restrict the orientation."""

    printer: Printer = None
    material: Material = None
    sets: Sets = None
    time_limit: Annotated[
        float | None,
        job_option(
            "--time-limit",
            min=0.0,
            metavar="SECONDS",
            help="Stop searching after this time and use the best result found.",
        ),
    ] = None
    output: Annotated[
        Path | None,
        output_option(
            "-o",
            "--output",
            metavar="FOLDER",
            help="Folder for a page, a JSON report and pictures; default: none.",
        ),
    ] = None
    as_json: ResultAsJson = False
    quiet: Quiet = False
    progress: ProgressForm = "bars"
    plugins: Plugins = None
    no_plugins: NoPlugins = False
    workers: Workers = None
    log: LogFile = None
    debug: Debug = False

    @property
    def changes(self) -> dict[str, Any]:
        """The settings of the job that options change, by dotted keys; None where an option is not given."""
        return {"printer": self.printer, "material": self.material, **self.reading}


@with_options(OrientationOptions)
def orient(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="PART",
            help="Mesh files, 3MF files and folders, or a job file (.toml).",
            show_default=False,
        ),
    ],
    effort: Annotated[
        Literal["fast", "normal", "thorough"],
        typer.Option(
            metavar="LEVEL",
            help="Orientations of each part that are measured exactly: fast 5, normal 10, thorough 20, for which "
            "supports are planned, too.",
        ),
    ] = "normal",
    no_contact: Annotated[
        list[str] | None,
        typer.Option(metavar="FACES", help=f"Faces that neither the plate nor a support may touch: {_FACES}"),
    ] = None,
    face_up: Annotated[
        list[str] | None,
        typer.Option(metavar="FACES", help="Faces that must look up, to within 45 degrees; repeatable."),
    ] = None,
    face_down: Annotated[
        list[str] | None,
        typer.Option(metavar="FACES", help="Faces that must look down, to within 45 degrees; repeatable."),
    ] = None,
    tilt: Annotated[
        float,
        typer.Option(
            min=0.0,
            max=180.0,
            metavar="DEGREES",
            help="Largest angle by which a part may be tilted from the position in which it was drawn.",
        ),
    ] = 180.0,
    *,
    options: OrientationOptions,
) -> None:
    """Propose orientations in which parts cost little support, room and height.

    It tries more than 1,000 directions of each part, measures the best of them
    as the planner of supports does, and lists five that no other one beats in
    everything. Copy a rotation from --json to 'rotations' in a job file, or
    let a job choose: rotations = "orient".

    Exit codes: 0 if done, 2 for wrong input or if a part has no allowed
    orientation, 130 or 143 if Ctrl-C or SIGTERM ended it (nothing written).
    """
    own = {
        "effort": effort,
        "no_contact": no_contact or (),
        "face_up": face_up or (),
        "face_down": face_down or (),
        "tilt_deg": tilt,
        "output": options.output,
        "time_limit_s": options.time_limit,
    }
    record = call_api("orient", inputs, options, {}, **own)

    from amprep.report.orientation.json_form import to_json
    from amprep.report.orientation.terminal import summary

    finish(record, to_json, lambda found: summary(found, options.output or Path()), options)
