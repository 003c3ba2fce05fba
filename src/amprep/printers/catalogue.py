"""Printers: the profiles shipped, those of the project or the user, and finding one by name."""

import os
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from amprep.errors import JobError
from amprep.model.build_volume import BuildVolume
from amprep.typed import make
from amprep.validation import read_table, require

Technology = Literal["metal-powder-bed", "polymer-powder-bed", "filament"]
Origin = Literal["built-in", "project", "user", "job"]

DEFAULT_PRINTER = "EOS M290"
SHIPPED = Path(__file__).parent / "profiles"


@dataclass(frozen=True)
class Profile:
    """The keys of a printer profile.

    Attributes
    ----------
    size_mm
        x, y, z of a box, or diameter and height of a cylinder.
    zones
        Forbidden boxes, each x0, y0, z0, x1, y1, z1 in build coordinates.
    source
        Where the sizes come from, e.g. the manufacturer's data sheet.
    """

    size_mm: tuple[float, float, float] | tuple[float, float]
    name: str = ""
    technology: Technology = "metal-powder-bed"
    shape: Literal["box", "cylinder"] = "box"
    zones: tuple[tuple[float, float, float, float, float, float], ...] = ()
    source: str = ""

    def __post_init__(self) -> None:
        require(min(self.size_mm) > 0, "size_mm needs sizes above 0", list(self.size_mm))
        require(max(self.size_mm) <= 10_000, "size_mm may be at most 10000 mm each", list(self.size_mm))
        expected = "diameter and height" if self.shape == "cylinder" else "x, y and z"
        count = 2 if self.shape == "cylinder" else 3
        require(len(self.size_mm) == count, f"size_mm of a {self.shape} is {expected}", list(self.size_mm))
        for zone in self.zones:
            ordered = all(lo < hi for lo, hi in zip(zone[:3], zone[3:], strict=True))
            require(ordered, "zones are x0, y0, z0, x1, y1, z1 with each 0 below its 1", list(zone))


@dataclass(frozen=True, eq=False)
class Printer:
    """A printer as a job uses it.

    Attributes
    ----------
    source
        Where its sizes come from.
    origin
        Whether the profile is built in, or of the project, the user or the job.
    """

    name: str
    technology: Technology
    space: BuildVolume
    source: str = ""
    origin: Origin = "built-in"

    @property
    def stacks(self) -> bool:
        """Whether parts may lie above one another unless the job says otherwise."""
        return self.technology == "polymer-powder-bed"  # loose powder holds the parts

    @property
    def needs_supports(self) -> bool:
        """Whether overhangs need supports unless the job says otherwise."""
        return self.technology != "polymer-powder-bed"


def find_printer(name: str, folder: Path | None = None, env: Mapping[str, str] = os.environ) -> Printer:
    """Return the printer called `name`, whatever its case, spaces and dashes; or that of a profile's path.

    Parameters
    ----------
    folder
        The project's folder: relative paths start there, and its ``printers`` folder is looked at first.
    env
        Says where the user's configuration folder is.

    Raises
    ------
    JobError
        When there is no such printer (with the nearest name), or its profile is wrong.
    """
    if name.lower().endswith(".toml"):
        return read_printer((folder or Path()) / name, "job")
    for path, origin in _profile_files(folder, env):
        if plain(path.stem) == plain(name) or _states_name(path, origin, name):
            return read_printer(path, origin)
    printers, warnings = list_printers(folder, env)
    known = {plain(printer.name): printer.name for printer in printers}
    close = get_close_matches(plain(name), known, n=1)
    hint = f" (did you mean {known[close[0]]!r}?)" if close else "; 'amprep printers' lists them"
    raise JobError("; ".join([f"no printer is called {name!r}{hint}", *warnings]))


def list_printers(
    folder: Path | None = None, env: Mapping[str, str] = os.environ
) -> tuple[list[Printer], list[str]]:
    """Return all printers, the project's first, then the user's, then the built-in ones; and warnings.

    A profile that is wrong is a warning; a name met before hides later ones.
    """
    found: dict[str, Printer] = {}
    warnings: list[str] = []
    for path, origin in _profile_files(folder, env):
        try:
            printer = read_printer(path, origin)
        except JobError as error:
            warnings.append(str(error))
        else:
            found.setdefault(plain(printer.name), printer)
    return list(found.values()), warnings


def read_printer(path: Path, origin: Origin) -> Printer:
    """Read one profile.

    Raises
    ------
    JobError
        When the file is not a printer profile.
    """
    return _shipped(path) if origin == "built-in" else _read(path, origin)


def printer_from_table(table: Mapping[str, Any], where: str, name: str, origin: Origin = "job") -> Printer:
    """Return the printer a table of plain values describes; `name` serves one that has none."""
    if "size_mm" not in table:
        raise JobError(f"{where}: expected size_mm = [x, y, z], found none")
    profile = make(Profile, table, where)
    size = profile.size_mm if len(profile.size_mm) == 3 else (profile.size_mm[0], *profile.size_mm)
    zones = np.array(profile.zones).reshape(-1, 6)
    space = BuildVolume(np.array(size), profile.shape, zones[:, :3], zones[:, 3:])
    return Printer(profile.name or name, profile.technology, space, profile.source, origin)


def user_folder(env: Mapping[str, str], platform: str = sys.platform) -> Path:
    """Return the folder of the user's own printers, by the custom of the platform."""
    home = Path(env.get("HOME") or env.get("USERPROFILE") or Path.home())
    if platform == "darwin":
        base = home / "Library" / "Application Support"
    elif platform == "win32":
        base = Path(env.get("APPDATA") or home / "AppData" / "Roaming")
    else:
        base = Path(env.get("XDG_CONFIG_HOME") or home / ".config")
    return base / "amprep" / "printers"


def plain(name: str) -> str:
    """Return a printer's name without case, spaces and punctuation."""
    return re.sub(r"[\W_]+", "", name.casefold())


def _profile_files(folder: Path | None, env: Mapping[str, str]) -> list[tuple[Path, Origin]]:
    places: list[tuple[Path, Origin]] = [
        ((folder or Path()) / "printers", "project"),
        (user_folder(env), "user"),
        (SHIPPED, "built-in"),
    ]
    return [(path, origin) for place, origin in places for path in sorted(place.glob("*.toml"))]


def _states_name(path: Path, origin: Origin, name: str) -> bool:
    """Whether the profile is one, and says that this is its name."""
    try:
        return plain(read_printer(path, origin).name) == plain(name)
    except JobError:
        return False


def _read(path: Path, origin: Origin) -> Printer:
    return printer_from_table(read_table(path, "printer"), str(path), path.stem, origin)


@cache
def _shipped(path: Path) -> Printer:
    """Profiles shipped with amprep do not change while it runs."""
    return _read(path, "built-in")
