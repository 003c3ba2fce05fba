"""``amprep doctor``: say what is installed and what amprep finds on this machine."""

import json
import os
import platform
import re
import shutil
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, requires, version
from typing import Any

import typer

from amprep import __version__
from amprep.cli.options import AsJson
from amprep.cli.setup.kernels import compiled_kernels

_SLICERS = {
    "PrusaSlicer": ("prusa-slicer", "PrusaSlicer", "prusa-slicer-console"),
    "SuperSlicer": ("superslicer", "SuperSlicer"),
    "OrcaSlicer": ("orca-slicer", "OrcaSlicer"),
    "Bambu Studio": ("bambu-studio", "BambuStudio"),
    "Cura": ("cura", "UltiMaker-Cura"),
    "CuraEngine": ("CuraEngine", "curaengine"),
}
"""Programs by the names that their commands have."""

_WAIT_S = 5.0
"""Longest time for a program to state its version."""


def doctor(as_json: AsJson = False) -> None:
    """Say what is installed: packages, slicers, plugins, profiles, compiled code.

    Add the output to a report of a fault.
    """
    found = _findings()
    if as_json:
        typer.echo(json.dumps(found, indent=2))
        return
    for heading, entries in found.items():
        typer.echo(f"{heading}:")
        for name, value in entries.items():
            typer.echo(f"  {name}: {value}")


def _findings() -> dict[str, dict[str, Any]]:
    return {
        "amprep": {
            "version": __version__,
            "Python": f"{platform.python_version()} ({sys.executable})",
            "system": f"{platform.system()} {platform.machine()}, {os.cpu_count()} processors",
        },
        "packages": _packages(),
        "slicers": {name: _program(commands) for name, commands in _SLICERS.items()},
        "plugins": _plugins(),
        "profiles": _profiles(),
        "numeric code": {"compiled functions": compiled_kernels()},
    }


def _requirements() -> list[str]:
    """Return what amprep requires; nothing where its files are used without an installation."""
    try:
        return requires("amprep") or []
    except PackageNotFoundError:
        return []


def _packages() -> dict[str, str]:
    """Return the version of each package that amprep needs, or may use."""
    found = {}
    for requirement in _requirements():
        name = re.split(r"[^\w.-]", requirement, maxsplit=1)[0]
        optional = "extra ==" in requirement
        if "test" in requirement.partition("extra ==")[2]:
            continue
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            if not optional:
                found[name] = "missing; install amprep again"
    return found


def _program(commands: tuple[str, ...]) -> str:
    """Return the version of a program and where it is."""
    path = next(filter(None, map(shutil.which, commands)), None)
    if path is None:
        return "not found"
    try:
        run = subprocess.run(  # noqa: S603 the commands are those above
            [path, "--help"], capture_output=True, text=True, timeout=_WAIT_S, check=False, errors="replace"
        )
    except (OSError, subprocess.SubprocessError):
        return path
    stated = re.search(r"\d+\.\d+\.\d+", run.stdout + run.stderr)
    return f"{stated[0]} ({path})" if stated else path


def _plugins() -> dict[str, str]:
    """Return the offers of each plugin by kind, and the warnings."""
    from amprep.host import Host
    from amprep.host.offers import KINDS

    host = Host.load()
    offers: dict[str, list[str]] = {}
    for kind in KINDS:
        by_origin: dict[str, list[str]] = {}
        for name, listed in host.offers(kind).items():
            by_origin.setdefault("built-in" if listed.builtin else listed.origin, []).append(name)
        for origin, names in by_origin.items():
            offers.setdefault(origin, []).append(f"{KINDS[kind].noun}s {', '.join(sorted(names))}")
    found = {origin: "; ".join(kinds) for origin, kinds in offers.items()}
    return found | {f"warning {number}": text for number, text in enumerate(host.warnings, 1)}


def _profiles() -> dict[str, str]:
    from amprep.materials.catalogue import list_materials
    from amprep.printers.catalogue import list_printers
    from amprep.profiles import user_folder

    found = {}
    for kind, (profiles, warnings) in (("printers", list_printers()), ("materials", list_materials())):
        own = sum(each.origin != "built-in" for each in profiles)
        folder = user_folder(os.environ, kind)
        found[kind] = f"{len(profiles)}, {own} of them your own (in {folder})"
        found |= {f"warning about {kind} {number}": text for number, text in enumerate(warnings, 1)}
    return found
