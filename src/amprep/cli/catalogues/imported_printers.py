"""``amprep printers import``: make profiles of printers from those of slicers."""

import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from amprep.cli.options import AsJson, Force

if TYPE_CHECKING:
    from amprep.printers.catalogue import PrinterProfile


def import_printers(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Profile of PrusaSlicer or SuperSlicer (.ini), OrcaSlicer or Bambu Studio (.json), "
            "Cura (.def.json), or a folder with such files.",
        ),
    ],
    only: Annotated[
        list[str] | None,
        typer.Option("--only", metavar="NAME", help="Import this printer only; repeatable."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FOLDER",
            help="Folder for the profiles; default: your configuration folder.",
        ),
    ] = None,
    force: Force = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="List the printers, but write nothing.")] = False,
    as_json: AsJson = False,
) -> None:
    """Make printer profiles from those of a slicer: bed, height and forbidden zones.

    Jobs can name the printers afterwards. Beds may be polygons, round,
    or lie anywhere around the origin of the machine.
    """
    import os

    from amprep.model.counting import counted
    from amprep.printers.imported.read import read_printers
    from amprep.profiles import user_folder
    from amprep.report.terminal import printable

    profiles, warnings = read_printers(source)
    profiles = _chosen(profiles, only or [])
    folder = output or user_folder(os.environ, "printers")
    for warning in warnings:
        typer.echo(f"amprep: warning: {printable(warning)}", err=True)
    written = [] if dry_run else _write(profiles, folder, force=force)
    if as_json:
        records = [asdict(profile) for profile in profiles]
        typer.echo(json.dumps({"printers": records, "files": [str(path) for path in written]}, indent=2))
        return
    for profile in profiles:
        typer.echo(printable(f"{profile.name}: {_size(profile)}"))
    if written:
        typer.echo(f"{counted(len(written), 'profile')} written to {folder}")


def _chosen(profiles: "list[PrinterProfile]", names: list[str]) -> "list[PrinterProfile]":
    from difflib import get_close_matches

    from amprep.errors import JobError
    from amprep.profiles import normalised

    if not names:
        return profiles
    known = {normalised(profile.name): profile for profile in profiles}
    for name in names:
        if normalised(name) not in known:
            close = get_close_matches(normalised(name), known, n=1)
            hint = f" (did you mean {known[close[0]].name!r}?)" if close else "; --dry-run lists them"
            raise JobError(f"no printer in the file is called {name!r}{hint}")
    return [known[normalised(name)] for name in names]


def _write(profiles: "list[PrinterProfile]", folder: Path, *, force: bool) -> list[Path]:
    """Write one file for each profile, all or none; without `force`, an existing file is an error."""
    from amprep.errors import AmprepError
    from amprep.pipeline.outputs import OutputFolder
    from amprep.profiles import profile_text

    paths = [folder / f"{stem}.toml" for stem in _stems([profile.name for profile in profiles])]
    known = [path for path in paths if path.exists()]
    if known and not force:
        raise AmprepError(f"{known[0]} exists already; use --force to replace it, or -o for another folder")
    with OutputFolder(folder, "printers") as outputs:
        try:
            for profile, path in zip(profiles, paths, strict=True):
                outputs.named(path.name).write_text(profile_text(asdict(profile)), encoding="utf-8")
        except OSError as error:
            raise AmprepError(f"cannot write to the folder {folder}: {error.strerror or error}") from error
        outputs.publish()
    return paths


def _stems(names: list[str]) -> list[str]:
    """Return a name of a file for each printer, all different, also where capital letters do not count."""
    stems: list[str] = []
    taken: set[str] = set()
    for name in names:
        plain = re.sub(r"[^\w.+-]+", "-", name).strip("-.") or "printer"
        stem, number = plain, 1
        while stem.lower() in taken:
            number += 1
            stem = f"{plain}-{number}"
        taken.add(stem.lower())
        stems.append(stem)
    return stems


def _size(profile: "PrinterProfile") -> str:
    from amprep.model.counting import counted

    size = [f"{value:g}" for value in profile.size_mm]
    shape = " x ".join(size) if profile.shape == "box" else f"diameter {size[0]}, height {size[1]}"
    x, y = profile.origin_mm
    corner = f", corner at ({x:g}, {y:g})" if x or y else ""
    zones = f", {counted(len(profile.zones), 'forbidden zone')}" if profile.zones else ""
    return f"{shape} mm{corner}{zones}"
