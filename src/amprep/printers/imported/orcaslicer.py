"""Read the printers of OrcaSlicer's profiles (``.json``), which inherit from others by name."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from amprep.errors import InputError
from amprep.printers.catalogue import PrinterProfile
from amprep.printers.imported.beds import profile_of_bed
from amprep.printers.imported.texts import MOST_PARENTS, number_of, outline_of

ReadJson = Callable[[Path], Any]


def is_printer(table: Mapping[str, Any]) -> bool:
    """Tell whether a profile is one of a printer, and no parent of others alone."""
    of_machine = table.get("type", "machine") == "machine" and "machine_model" not in table
    is_one = of_machine and str(table.get("instantiation", "true")).lower() != "false"
    return bool(is_one and {"printable_area", "inherits"} & table.keys())


def read_machine(table: Mapping[str, Any], path: Path, read: ReadJson) -> PrinterProfile:
    """Return the printer of a profile.

    Parameters
    ----------
    table
        Its keys.
    path
        Its file; profiles that it inherits from are searched in the same folder.
    read
        Reads a JSON file.

    Raises
    ------
    InputError
        If a profile that it inherits from is missing, or a value is wrong.
    """
    name = str(table.get("name") or path.stem)
    own = _with_parents(table, path, read)
    area, height = own.get("printable_area"), own.get("printable_height")
    if area is None or height is None:
        raise InputError(f"{path}: {name!r} states no printable_area or no printable_height")
    outline = outline_of(_corners(area), name)
    excluded = _corners(own.get("bed_exclude_area") or "")
    areas = [outline_of(excluded, name)] if excluded.count(",") > 1 else []
    source = f"OrcaSlicer, {path.name}"
    return profile_of_bed(name, outline, number_of(height, name, "height"), source, areas)


def _corners(value: Any) -> str:
    return ",".join(map(str, value)) if isinstance(value, list) else str(value)


def _with_parents(table: Mapping[str, Any], path: Path, read: ReadJson) -> dict[str, Any]:
    """Return the keys of a profile and of those that it inherits from; the nearest has precedence."""
    chain = [table]
    while parent := str(chain[-1].get("inherits") or ""):
        if len(chain) > MOST_PARENTS:
            raise InputError(f"{path}: inherits from itself, or through more than {MOST_PARENTS} others")
        above = path.parent / f"{Path(parent).name}.json"
        if not above.is_file():
            if {"printable_area", "printable_height"} <= {key for each in chain for key in each}:
                break
            raise InputError(
                f"{path}: inherits from {parent!r}, which is not in its folder; put both into one folder"
            )
        chain.append(_table(read(above), above))
    return {key: value for each in reversed(chain) for key, value in each.items()}


def _table(value: Any, path: Path) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise InputError(f"{path}: not a profile: expected an object")
    return value
