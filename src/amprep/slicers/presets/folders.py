"""Where slicers keep the print profiles of their users."""

import difflib
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from amprep.errors import InputError

Slicer = Literal["prusaslicer", "superslicer", "orcaslicer"]
SLICERS: tuple[Slicer, ...] = get_args(Slicer)

_MOST_SHOWN = 8


@dataclass(frozen=True)
class SlicerFolders:
    """The folders of one slicer.

    Attributes
    ----------
    name
        Name of the slicer, and of its folder of settings.
    flatpak
        Its identifier as a Flatpak.
    profiles
        Patterns of the print profiles inside that folder.
    """

    name: str
    flatpak: str
    profiles: tuple[str, ...]


FOLDERS: dict[Slicer, SlicerFolders] = {
    "prusaslicer": SlicerFolders("PrusaSlicer", "com.prusa3d.PrusaSlicer", ("print/*.ini",)),
    "superslicer": SlicerFolders("SuperSlicer", "com.github.supermerill.SuperSlicer", ("print/*.ini",)),
    "orcaslicer": SlicerFolders(
        "OrcaSlicer",
        "io.github.softfever.OrcaSlicer",
        ("user/*/process/*.json", "user/*/process/base/*.json"),
    ),
}


def settings_folders(slicer: Slicer, environment: Mapping[str, str], home: Path) -> list[Path]:
    """Return where a slicer may keep its settings on this system, the usual place first."""
    names = FOLDERS[slicer]
    if sys.platform == "win32":
        return [Path(environment.get("APPDATA") or home / "AppData" / "Roaming") / names.name]
    if sys.platform == "darwin":
        return [home / "Library" / "Application Support" / names.name]
    usual = Path(environment.get("XDG_CONFIG_HOME") or home / ".config")
    return [usual / names.name, home / ".var" / "app" / names.flatpak / "config" / names.name]


def find_profile(slicer: Slicer, name: str, folders: list[Path]) -> Path:
    """Return the file of a user's print profile.

    Raises
    ------
    InputError
        If there is none of this name; profiles that came with the slicer are not files of their own.
    """
    patterns = FOLDERS[slicer].profiles
    files = [path for folder in folders for pattern in patterns for path in sorted(folder.glob(pattern))]
    for path in files:
        if path.stem == name:
            return path
    program = FOLDERS[slicer].name
    if not files:
        places = " and ".join(map(str, folders))
        raise InputError(
            f"{program} has no print profile of yours in {places}; save one in the slicer under a name of its own"
        )
    names = list(dict.fromkeys(path.stem for path in files))
    near = difflib.get_close_matches(name, names, _MOST_SHOWN) or names[:_MOST_SHOWN]
    raise InputError(
        f"{program} has no print profile called {name!r}; there are {', '.join(map(repr, near))}; "
        "save a profile that came with the slicer under a name of its own first"
    )
