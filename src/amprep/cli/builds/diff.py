"""``amprep diff``: say in what two builds differ."""

import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep import cli

if TYPE_CHECKING:
    from amprep.measures.differences.records import BuildDifferences


def diff(
    before: Annotated[Path, typer.Argument(metavar="A.3mf", help="A build file that amprep wrote.")],
    after: Annotated[Path, typer.Argument(metavar="B.3mf", help="Another one, usually a later one.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,  # noqa: ARG001 - `main` reads it
) -> None:
    """Say in what two builds differ: parts, positions, supports, listed overhangs, settings.

    The geometry is compared, not the bytes: files of one build for different
    programs differ in the setting `target` alone.

    Exit codes: 0 if the builds are equal, 1 if they differ, 2 if a file is
    not a build that amprep wrote.
    """
    from amprep import api

    found = api.diff(before, after)
    if as_json:
        typer.echo(json.dumps(asdict(found), indent=2))
    else:
        for line in _lines(found):
            typer.echo(line)
    raise typer.Exit(cli.DONE if found.none else cli.INCOMPLETE)


def _lines(found: "BuildDifferences") -> Iterator[str]:
    """Yield one line for each difference."""
    for part in found.parts:
        far = f" by up to {part.moved_mm:.3f} mm" if part.change in ("moved", "turned") else ""
        turned = f", by {part.turned_deg:.2f} degrees" if part.turned_deg else ""
        yield f"part {part.label}: {part.change}{turned}{far}"
    for support in found.supports:
        volumes = [f"{volume / 1000:.3f} cm³" for volume in (support.before_mm3, support.after_mm3)]
        yield f"supports of {', '.join(support.parts)}: {volumes[0]} before, {volumes[1]} after"
    for listed in found.listed:
        yield (
            f"unsupported at {listed.part}: {listed.before_mm2:.2f} mm² in {listed.before} before, "
            f"{listed.after_mm2:.2f} mm² in {listed.after} after"
        )
    for setting in found.settings:
        yield f"setting {setting.name}: {setting.before} before, {setting.after} after"
    if found.none:
        yield "the builds are equal"
