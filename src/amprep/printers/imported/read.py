"""Read the printers in a file or folder of a slicer."""

from dataclasses import replace
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import Any

from amprep.errors import InputError
from amprep.files import read_json
from amprep.printers.catalogue import PrinterProfile
from amprep.printers.imported.cura import SUFFIX, is_visible, read_definition
from amprep.printers.imported.orcaslicer import is_printer, read_machine
from amprep.printers.imported.prusaslicer import read_ini
from amprep.printers.imported.texts import LARGEST_FILE

LARGEST_JSON, MOST_KEPT = 2_000_000, 32
"""Bytes of a profile in JSON (those of slicers have up to 500,000), and how many are kept for their children."""

MOST_FILES = 100_000
"""Largest number of files and folders in a folder of profiles; that of OrcaSlicer has 15,000."""


def read_printers(path: Path) -> tuple[list[PrinterProfile], list[str]]:
    """Return the printers of a slicer's profile, or of all profiles in a folder.

    Parameters
    ----------
    path
        A configuration or bundle of PrusaSlicer or SuperSlicer (``.ini``), a profile of OrcaSlicer or Bambu Studio
        (``.json``), a definition of Cura (``.def.json``), or a folder with such files.

    Returns
    -------
    printers, warnings
        Printers of different names, and one sentence for each file of a folder that could not be imported.

    Raises
    ------
    InputError
        If the file cannot be read or has no printer, or the folder has too many files.
    """
    if not path.exists():
        raise InputError(f"{path}: no such file or folder; name a profile of a slicer, or a folder with them")
    read = lru_cache(MOST_KEPT)(lambda path: read_json(path, "a profile", LARGEST_JSON))
    if not path.is_dir():
        return _named_apart(_of_file(path, read)), []
    printers: list[PrinterProfile] = []
    warnings: list[str] = []
    for each in _files_in(path):
        try:
            if _is_offered(each, read):
                printers += _of_file(each, read)
        except InputError as error:
            warnings.append(str(error))
    if not printers:
        raise InputError(
            f"{path}: has no printer profiles of PrusaSlicer (.ini), OrcaSlicer (.json) or Cura (.def.json)"
        )
    return _named_apart(printers), warnings


def _files_in(folder: Path) -> list[Path]:
    found = list(islice(folder.rglob("*"), MOST_FILES + 1))
    if len(found) > MOST_FILES:
        raise InputError(
            f"{folder}: has more than {MOST_FILES} files; choose the folder of the profiles alone"
        )
    return sorted(found)


def _is_offered(path: Path, read: Any) -> bool:
    """Tell whether a file is a printer, and no parent of others alone."""
    if path.name.endswith(SUFFIX):
        return is_visible(path, read)
    if path.suffix == ".json":
        table = read(path)
        return isinstance(table, dict) and table.get("type") == "machine" and is_printer(table)
    return path.suffix == ".ini"


def _of_file(path: Path, read: Any) -> list[PrinterProfile]:
    if path.name.endswith(SUFFIX):
        return [read_definition(path, read)]
    if path.suffix == ".json":
        table = read(path)
        if not isinstance(table, dict) or not is_printer(table):
            raise InputError(f"{path}: is no printer of OrcaSlicer (one has printable_area, or inherits it)")
        return [read_machine(table, path, read)]
    if path.suffix == ".ini":
        return read_ini(_text(path), path)
    raise InputError(
        f"{path}: expected a profile of PrusaSlicer (.ini), OrcaSlicer (.json) or Cura (.def.json)"
    )


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InputError(f"{path}: larger than {LARGEST_FILE >> 20} MiB, which no profile is")
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error


def _named_apart(printers: list[PrinterProfile]) -> list[PrinterProfile]:
    """Return the printers, the first of each name; later ones with another bed get a number."""
    found: dict[str, PrinterProfile] = {}
    for each in printers:
        name, number = each.name, 1
        while name in found and replace(found[name], name="", source="") != replace(each, name="", source=""):
            number += 1
            name = f"{each.name} ({number})"
        found.setdefault(name, replace(each, name=name))
    return list(found.values())
