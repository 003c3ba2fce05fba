"""Read the printers of Cura's definitions (``.def.json``), which inherit from others by the names of their files.

Cura's disallowed areas are relative to the middle of the bed, with y to the front. Cura places the objects of a 3MF
file from the corner of the bed, also where ``machine_center_is_zero`` is set; so no origin is needed.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError
from amprep.printers.catalogue import PrinterProfile
from amprep.printers.imported.beds import profile_of_bed
from amprep.printers.imported.texts import MOST_PARENTS, number_of

SUFFIX = ".def.json"

_USUAL = {"machine_width": 100, "machine_depth": 100, "machine_height": 100}
"""What Cura takes where no definition states anything."""

_MOST_AREAS = 1000

_CORNERS = 64
"""Number of corners by which an ellipse is approximated, from inside."""


def read_definition(path: Path, read: Callable[[Path], Any]) -> PrinterProfile:
    """Return the printer of a definition.

    Parameters
    ----------
    path
        The file; definitions that it inherits from are searched in the same folder.
    read
        Reads a JSON file.

    Raises
    ------
    InputError
        If a definition that it inherits from is missing, or a value is wrong.
    """
    chain = _chain(path, read)
    name = str(chain[0].get("name") or path.name.removesuffix(SUFFIX))
    width, depth, height = (
        number_of(_value(chain, key, usual), name, key.removeprefix("machine_"))
        for key, usual in _USUAL.items()
    )
    shape = str(_value(chain, "machine_shape", "rectangular")).lower()
    outline = np.array([[0.0, 0.0], [width, 0.0], [width, depth], [0.0, depth]])
    if shape == "elliptic":
        angle = 2.0 * np.pi * np.arange(_CORNERS) / _CORNERS
        outline = (np.stack([np.cos(angle), np.sin(angle)], axis=1) + 1.0) * (width / 2.0, depth / 2.0)
    areas = _areas(_value(chain, "machine_disallowed_areas", []), width, depth, name)
    profile = profile_of_bed(name, outline, height, f"Cura, {path.name}", areas)
    return replace(profile, origin_mm=(0.0, 0.0))


def is_visible(path: Path, read: Callable[[Path], Any]) -> bool:
    """Tell whether a definition is a printer that Cura offers, and no parent of others alone."""
    own = read(path)
    metadata = own.get("metadata") if isinstance(own, dict) else None
    return isinstance(metadata, dict) and metadata.get("visible", False) is True


def _chain(path: Path, read: Callable[[Path], Any]) -> list[Mapping[str, Any]]:
    """Return a definition and those that it inherits from."""
    chain: list[Mapping[str, Any]] = []
    while len(chain) <= MOST_PARENTS:
        own = read(path)
        if not isinstance(own, dict):
            raise InputError(f"{path}: not a definition of Cura: expected an object")
        chain.append(own)
        parent = Path(str(own.get("inherits") or "")).name
        if not parent:
            return chain
        above = path.with_name(parent + SUFFIX)
        if not above.is_file():
            if parent == "fdmprinter":  # the root, whose sizes are the usual ones
                return chain
            raise InputError(
                f"{path}: inherits from {parent!r}, which is not in its folder; put both into one folder"
            )
        path = above
    raise InputError(f"{path}: inherits from itself, or through more than {MOST_PARENTS} others")


def _value(chain: list[Mapping[str, Any]], key: str, usual: Any) -> Any:
    """Return a setting: the nearest ``value``, or else the nearest ``default_value``; formulas do not count.

    In Cura a value hides all default values, also those of definitions that inherit it.
    """
    stated = [each for own in chain for each in _stated(own, key)]
    for each in stated:
        value = each.get("value")
        if value is not None and (not isinstance(value, str) or _is_number(value)):
            return value
    return next((each["default_value"] for each in stated if "default_value" in each), usual)


def _stated(own: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    """Return what a definition says about a setting: nothing, or one table."""
    overrides = own.get("overrides")
    stated = overrides.get(key) if isinstance(overrides, dict) else None
    stated = stated or _in_tree(own.get("settings"), key)
    return [stated] if isinstance(stated, dict) else []


def _in_tree(settings: Any, key: str) -> Any:
    """Return a setting from the tree of categories of the root definition."""
    open_tables = [settings]
    while open_tables:
        table = open_tables.pop()
        if isinstance(table, dict):
            if key in table:
                return table[key]
            open_tables += [each.get("children") for each in table.values() if isinstance(each, dict)]
    return None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _areas(value: Any, width: float, depth: float, name: str) -> list[Floats]:
    """Return outlines ``(k, 2)`` of disallowed areas from the corner of the bed, mm."""
    try:
        outlines = [
            np.array(area, np.float64).reshape(-1, 2) for area in value[:_MOST_AREAS] if len(area) > 2
        ]
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: machine_disallowed_areas must be lists of corners [x, y]") from error
    return [np.array([width / 2.0, depth / 2.0]) + outline * (1.0, -1.0) for outline in outlines]
