"""Read the table of a cell's TOML file: its graph, its conditions and its promises."""

import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from amprep.errors import InputError, nearest_hint
from amprep.model import GraphCell, When

LARGEST_FILE = 4 * 1024 * 1024
"""Bytes."""

MOST_STRUTS = 2000
"""Largest number of struts and walls in a cell."""

ABOUT = ("name", "summary", "author", "licence", "smallest_feature_mm", "least_angle_deg", "size_mm")
"""Keys that are allowed only at the top of the file."""

SHAPE = ("mesh", "points", "struts", "radius_mm", "faces", "thickness_mm", "growth", "full_load")
"""Keys of a shape, at the top of the file or in a variant."""

_WHEN = ("role", "edges", "load", "every", "layer")


def read_cell_table(path: Path) -> dict[str, Any]:
    """Return the table of a cell's TOML file after a check of its keys.

    Raises
    ------
    InputError
        If the file cannot be read, is too large, is not TOML or has an unknown key; the message names the nearest key.
    """
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InputError(f"{path}: a cell's TOML file must not exceed {LARGEST_FILE >> 20} MiB")
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(f"{path}: not a TOML file ({str(error) or 'nested too deeply'})") from error
    _require_keys(table, (*ABOUT, *SHAPE, "variant"), str(path))
    for variant in variants_of(table, path):
        _require_keys(variant, (*SHAPE, "when"), f"{path}: [[variant]]")
    return table


def variants_of(table: Mapping[str, Any], path: Path) -> list[Mapping[str, Any]]:
    """Return the tables of the variants.

    Raises
    ------
    InputError
        If they are not a list of tables.
    """
    variants = table.get("variant", [])
    if not isinstance(variants, list) or not all(isinstance(each, dict) for each in variants):
        raise InputError(f"{path}: variants must be written as tables [[variant]]")
    return variants


def text(table: Mapping[str, Any], key: str, where: str) -> str:
    """Return a text of one line, or an empty text if the key is missing.

    Parameters
    ----------
    table, key
        Table, and the key of the text.
    where
        File and section, for messages.
    """
    value = table.get(key, "")
    if not isinstance(value, str) or not value.isprintable() or len(value) > 300:
        raise InputError(f"{where}: {key} must be a text of one line")
    return value


def number(table: Mapping[str, Any], key: str, where: str, default: float | None = None) -> float | None:
    """Return a finite number, or the default if the key is missing.

    Parameters
    ----------
    table, key
        Table, and the key of the number.
    where
        File and section, for messages.
    default
        Value of a missing key.
    """
    if key not in table:
        return default
    value = table[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{where}: {key} must be a number, got {value!r}")
    return float(value)


def graph_of(table: Mapping[str, Any], path: Path) -> GraphCell:
    """Return the graph that a table declares.

    Raises
    ------
    InputError
        For rows of the wrong length, points outside the cube, struts between points that do not exist, and so on.
    """
    default = number(table, "radius_mm", str(path), 0.3)
    struts, radii = _struts(table.get("struts", []), default, path)
    values = {
        "thickness": number(table, "thickness_mm", str(path), 0.0),
        "growth": number(table, "growth", str(path), 1.0),
        "full_load": number(table, "full_load", str(path), 2.0),
    }
    faces = _rows(table.get("faces", []), (3,), "faces", path)
    points = _rows(table.get("points", []), (3,), "points", path)
    if len(struts) + len(faces) > MOST_STRUTS:
        raise InputError(f"{path}: a cell must not have more than {MOST_STRUTS} struts and walls")
    try:
        return GraphCell(
            np.array(points, np.float64).reshape(-1, 3),
            np.array(struts, np.int32).reshape(-1, 2),
            np.array(radii, np.float64).reshape(-1, 2),
            np.array(_whole(faces, "faces", path), np.int32).reshape(-1, 3),
            **{name: value for name, value in values.items() if value is not None and name != "full_load"},
            full_load=int(values["full_load"] or 0),
        )
    except (ValueError, OverflowError) as error:
        raise InputError(f"{path}: {_short(error)}") from error


def when_of(table: Mapping[str, Any], path: Path) -> When:
    """Return the conditions of a variant.

    Raises
    ------
    InputError
        For an unknown word or an impossible bound.
    """
    when = table.get("when", {})
    if not isinstance(when, dict):
        raise InputError(f"{path}: when must be a table, as in when = {{role = 'foot'}}")
    _require_keys(when, _WHEN, f"{path}: when")
    roles = when.get("role", [])
    least, most = _load(when.get("load", [0, 1_000_000_000]), path)
    try:
        return When(
            frozenset([roles] if isinstance(roles, str) else roles),
            when.get("edges", "any"),
            least,
            most,
            _int(when.get("every", 1), "every", path),
            _int(when.get("layer", 0), "layer", path),
        )
    except (ValueError, TypeError) as error:
        raise InputError(f"{path}: when: {_short(error)}") from error


def _struts(rows: Any, default: float | None, path: Path) -> tuple[list[list[int]], list[list[float]]]:
    """Split rows of two points and up to two radii; a missing radius gets the default."""
    struts, radii = [], []
    for row in _rows(rows, (2, 3, 4), "struts", path):
        struts.append(_whole([row[:2]], "struts", path)[0])
        own = row[2:] or [default or 0.0]
        radii.append([own[0], own[-1]])
    return struts, radii


def _rows(rows: Any, lengths: tuple[int, ...], name: str, path: Path) -> list[list[float]]:
    """Return rows of finite numbers, each with one of the given lengths."""
    sizes = " or ".join(map(str, lengths))
    if not isinstance(rows, list) or not all(isinstance(row, list) and len(row) in lengths for row in rows):
        raise InputError(f"{path}: {name} must be a list of rows of {sizes} numbers")
    for row in rows:
        if not all(isinstance(x, int | float) and not isinstance(x, bool) and abs(x) < 1e9 for x in row):
            raise InputError(f"{path}: {name} must be a list of rows of {sizes} numbers, got {str(row)[:80]}")
    return rows


def _whole(rows: list[list[float]], name: str, path: Path) -> list[list[int]]:
    if not all(isinstance(x, int) for row in rows for x in row):
        raise InputError(f"{path}: {name} must refer to points by number, from 0")
    return [[int(x) for x in row] for row in rows]


def _load(value: Any, path: Path) -> tuple[int, int]:
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f"{path}: when: load must be a pair, the smallest and the largest number of paths")
    return _int(value[0], "load", path), _int(value[1], "load", path)


def _int(value: Any, name: str, path: Path) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise InputError(f"{path}: when: {name} must be a whole number, got {value!r}")
    return value


def _require_keys(table: Mapping[str, Any], known: tuple[str, ...], where: str) -> None:
    for key in table:
        if key not in known:
            raise InputError(f"{where}: unknown key {key!r}{nearest_hint(key, known)}")


def _short(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
