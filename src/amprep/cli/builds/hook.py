"""``amprep hook``: check the G-code that a slicer exports, and install that check in profiles of slicers."""

import json
import os
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from amprep import cli

SlicerName = Literal["prusaslicer", "superslicer", "orcaslicer"]

app = typer.Typer(
    name="hook",
    no_args_is_help=True,
    help="Check in the slicer that G-code prints what was prepared.",
)


@app.command("gcode")
def gcode(
    file: Annotated[Path, typer.Argument(metavar="FILE.gcode", help="The G-code; slicers append its path.")],
    build: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="The build file; default: the one that names of objects state."),
    ] = None,
    folder: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Where build files are; default: beside the G-code."),
    ] = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Refuse G-code that prints anything else: the export fails.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Check that G-code prints the build that it was made from.

    Slicers run it with each file that they export. It compares number,
    position, size and shape of the objects with the build file, and finds
    supports of the slicer's own and layers that are too thick. It writes a
    summary as comments into the G-code, and NAME.amprep.json beside it.

    Exit codes: 0 if done, also if something is wrong; with --strict 1 if
    something is wrong or no build is found (nothing is written); 2 if a file
    cannot be read.
    """
    from amprep.pipeline.post_processing.course import check_gcode, write_findings
    from amprep.report.gcode import gcode_json, refusal_lines, summary_lines
    from amprep.report.terminal import printable

    record = check_gcode(file, build=build, folder=folder, environment=os.environ)
    refused = strict and not record.ok
    written = None if refused else write_findings(record, file, os.environ)
    if as_json:
        typer.echo(json.dumps(gcode_json(record), indent=2))
    elif not refused:
        first, *others = summary_lines(record)
        for line in (f"amprep {first}", *others):
            typer.echo(printable(line))
        typer.echo(f"wrote {written}" if written else f"no JSON: the G-code goes to {record.host}")
    if not record.ok:
        for line in refusal_lines(record):
            sys.stderr.write(f"amprep: {printable(line)}\n")
    raise typer.Exit(cli.INCOMPLETE if refused else cli.DONE)


@app.command("install")
def install(
    slicer: Annotated[SlicerName, typer.Option(help="The slicer.")],
    profile: Annotated[str, typer.Option(metavar="NAME", help="Name of your print profile.")],
    write: Annotated[bool, typer.Option("--write", help="Write the settings into the profile.")] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Refuse G-code that prints anything else: the export fails.")
    ] = False,
    folder: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Where build files are; default: beside the G-code."),
    ] = None,
    settings: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="The slicer's folder of settings; default: the usual one."),
    ] = None,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Print the settings that make a slicer check its G-code, or write them.

    With --write they are written into your print profile: the command is
    added after the scripts that the profile has, and labels of objects are
    turned on. Close the slicer first, because it reads profiles when it starts.

    Exit codes: 0 if done, 2 if the profile does not exist or cannot be written.
    """
    from amprep.slicers.presets.install import install as install_in
    from amprep.slicers.presets.install import where_to_paste

    options = ["--strict"] * strict + ([] if folder is None else ["--folder", str(folder.resolve())])
    done = install_in(slicer, options, profile=profile, folder=settings, write=write)
    for line in done.lines:
        typer.echo(line)
    if done.profile is None:
        typer.echo(f"nothing was written; add --write, or paste the command into {where_to_paste(slicer)}:")
        typer.echo(done.command)
    else:
        typer.echo(f"wrote {done.profile}; start the slicer again to load it")
