"""Find profiles of printers and of materials: built-in ones, those of the project, and those of the user."""

import json
import os
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Generic, Literal, Protocol, TypeVar

from amprep.errors import JobError
from amprep.validation import read_table

Origin = Literal["built-in", "project", "user", "job"]


class HasName(Protocol):
    """A profile that has been read."""

    @property
    def name(self) -> str:
        """Its name in job files."""


T = TypeVar("T", bound=HasName)


@dataclass(frozen=True)
class Catalogue(Generic[T]):
    """Profiles of one kind, which are TOML files.

    Attributes
    ----------
    kind
        ``printer`` or ``material``; folders and the command are named after it.
    shipped
        Folder of the built-in profiles.
    read
        Reads a profile; raises `JobError` if it is invalid.
    folder
        The project's folder: the base of relative paths, and the parent of a folder with profiles, which is searched
        first.
    env
        Environment variables that determine the user's configuration folder.
    hidden
        Files that are left out.
    """

    kind: str
    shipped: Path
    read: Callable[[Path, Origin], T]
    folder: Path | None = None
    env: Mapping[str, str] = field(default_factory=lambda: os.environ)
    hidden: frozenset[Path] = frozenset()

    def find(self, name: str) -> T:
        """Return the profile with a name or path; case, spaces and punctuation of a name do not matter.

        Raises
        ------
        JobError
            If there is no such profile (with the most similar name), or it is invalid.
        """
        if name.lower().endswith(".toml"):
            return self.read((self.folder or Path()) / name, "job")
        wanted = normalised(name)
        for folder, origin in self._folders():
            files = self._files(folder)
            named = [path for path in files if normalised(path.stem) == wanted]
            named = named or [path for path in files if wanted in map(normalised, stated_names(path))]
            if named:
                return self.read(named[0], origin)
        profiles, warnings = self.listed()
        known = {normalised(profile.name): profile.name for profile in profiles}
        close = get_close_matches(wanted, known, n=1)
        hint = (
            f" (did you mean {known[close[0]]!r}?)" if close else f"; 'amprep {self.kind}s list' lists them"
        )
        raise JobError("; ".join([f"no {self.kind} is called {name!r}{hint}", *warnings]))

    def listed(self) -> tuple[list[T], list[str]]:
        """Return all profiles and warnings: those of the project, of the user, and built-in ones, in this order.

        The first profile of a name hides later ones. An invalid profile gives a warning.
        """
        found: dict[str, T] = {}
        warnings: list[str] = []
        places = [(path, origin) for folder, origin in self._folders() for path in self._files(folder)]
        for path, origin in places:
            try:
                profile = self.read(path, origin)
            except JobError as error:
                warnings.append(str(error))
            else:
                found.setdefault(normalised(profile.name), profile)
        return list(found.values()), warnings

    def _folders(self) -> list[tuple[Path, Origin]]:
        return [
            ((self.folder or Path()) / f"{self.kind}s", "project"),
            (user_folder(self.env, f"{self.kind}s"), "user"),
            (self.shipped, "built-in"),
        ]

    def _files(self, folder: Path) -> list[Path]:
        return [path for path in sorted(folder.glob("*.toml")) if path not in self.hidden]


def stated_names(path: Path) -> list[str]:
    """Return the names that a profile states as ``name`` and ``aliases``; none if it cannot be read."""
    try:
        table = read_table(path, "profile")
    except JobError:
        return []
    aliases = table.get("aliases", [])
    stated = [table.get("name"), *(aliases if isinstance(aliases, list) else [])]
    return [name for name in stated if isinstance(name, str)]


def profile_text(record: Mapping[str, Any]) -> str:
    """Return the text of a profile file with these keys; a key whose value is None is left out."""
    lines = [
        f"{key} = {json.dumps(value, ensure_ascii=False)}"
        for key, value in record.items()
        if value is not None
    ]
    return "\n".join([*lines, ""])


def user_folder(env: Mapping[str, str], kind: str, platform: str = sys.platform) -> Path:
    """Return the folder of the user's profiles of a kind, according to the conventions of the platform."""
    home = Path(env.get("HOME") or env.get("USERPROFILE") or Path.home())
    if platform == "darwin":
        base = home / "Library" / "Application Support"
    elif platform == "win32":
        base = Path(env.get("APPDATA") or home / "AppData" / "Roaming")
    else:
        base = Path(env.get("XDG_CONFIG_HOME") or home / ".config")
    return base / "amprep" / kind


def normalised(name: str) -> str:
    """Return a name in lower case, without spaces and punctuation."""
    return re.sub(r"[\W_]+", "", name.casefold())
