"""Install the check of G-code in a print profile of a slicer."""

import os
import shlex
import shutil
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from amprep.errors import InputError
from amprep.files import replacing
from amprep.slicers.presets.folders import FOLDERS, Slicer, find_profile, settings_folders
from amprep.slicers.presets.scripts import ini_lines, json_lines, with_script_ini, with_script_json

_LARGEST = 8 << 20
"""Largest profile that is read, bytes."""


@dataclass(frozen=True)
class Installation:
    """What makes a slicer check its G-code.

    Attributes
    ----------
    command
        The script, to which the slicer appends the path of the G-code.
    lines
        The settings as the profile has them.
    profile
        The profile that was written, None if none was.
    """

    command: str
    lines: tuple[str, ...]
    profile: Path | None = None


def install(
    slicer: Slicer,
    options: Sequence[str],
    *,
    profile: str,
    folder: Path | None,
    write: bool,
    environment: Mapping[str, str] = os.environ,
) -> Installation:
    """Return the settings that a profile needs, and write them into it if asked to.

    Parameters
    ----------
    options
        Options of the command that the slicer runs.
    profile
        Name of the user's print profile.
    folder
        The slicer's folder of settings; None for the usual one.
    write
        Whether to write.

    Raises
    ------
    InputError
        If the profile does not exist or cannot be read, which only writing needs.
    AmprepError
        If it cannot be written.
    """
    command = " ".join(_quoted(each) for each in (*_program(), "hook", "gcode", *options))
    is_json = slicer == "orcaslicer"
    lines = tuple((json_lines if is_json else ini_lines)([command]))
    if not write:
        return Installation(command, lines)
    folders = [folder] if folder is not None else settings_folders(slicer, environment, Path.home())
    path = find_profile(slicer, profile, folders)
    before = _read(path)
    try:
        text = (with_script_json if is_json else with_script_ini)(before, command)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="")
        shutil.copymode(path, temporary)
    return Installation(command, lines, path)


def where_to_paste(slicer: Slicer) -> str:
    """Return in which field of the slicer's window the command belongs."""
    if slicer == "orcaslicer":
        return "Process > Others > Post-processing scripts"
    return f"Print Settings > Output options > Post-processing scripts (and Label objects) of {FOLDERS[slicer].name}"


def _program() -> list[str]:
    """Return how to start amprep from anywhere."""
    script = Path(sys.argv[0])
    if script.stem == "amprep" and script.is_file():
        return [str(script.resolve())]
    return [sys.executable, "-m", "amprep"]


def _quoted(word: str) -> str:
    """Return a word of a command line as slicers run it: by the user's shell, on Windows without one."""
    if sys.platform == "win32":
        return f'"{word}"' if any(char.isspace() for char in word) else word
    return shlex.quote(word)


def _read(path: Path) -> str:
    try:
        if path.stat().st_size > _LARGEST:
            raise InputError(f"{path}: larger than {_LARGEST >> 20} MiB, which no profile is")
        return path.read_bytes().decode("utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a profile: not UTF-8 text") from error
