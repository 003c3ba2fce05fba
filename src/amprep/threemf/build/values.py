"""Write JSON that XML can carry, and read its values with checks: a file may contain anything."""

import json
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.validation import LARGEST_COORDINATE, LARGEST_COUNT

JsonObject = Mapping[str, Any]

_TO_ESCAPE = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]|[&<>]")
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def xml_text(text: str) -> str:
    """Return the text with U+FFFD in place of every character that XML forbids."""
    return _NOT_XML.sub("\ufffd", text)


def to_json(value: Any) -> str:
    """Return JSON that XML can carry without escapes; a list of objects has one line for each."""
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(to_json(entry) for entry in value) + "\n]"
    text = json.dumps(value, ensure_ascii=False, allow_nan=False)
    return _TO_ESCAPE.sub(lambda found: f"\\u{ord(found.group()):04x}", text)


def from_json(text: str) -> Any:
    """Return the value of JSON text.

    Raises
    ------
    ValueError
        If the text is not JSON or is nested too deeply.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("the JSON is nested too deeply") from None


def plain(array: Floats, decimals: int | None = None) -> Any:
    """Return an array as nested lists, with whole numbers as integers to keep the JSON short."""
    values = array if decimals is None else np.round(array, decimals)
    return _short(values.tolist())


def _short(values: list[Any]) -> list[Any]:
    if values and isinstance(values[0], list):
        return [_short(row) for row in values]
    return [int(value) if value.is_integer() and abs(value) < 2**53 else value for value in values]


def as_object(value: Any, name: str) -> JsonObject:
    """Return the value if it is a JSON object."""
    if not isinstance(value, dict):
        raise ValueError(f"{name} must be an object, got {_shown(value)}")
    return value


def as_list(value: Any, name: str) -> list[Any]:
    """Return the value if it is a JSON list."""
    if not isinstance(value, list):
        raise ValueError(f"{name} must be a list, got {_shown(value)}")
    return value


def number(
    record: JsonObject, name: str, least: float = -LARGEST_COUNT, most: float = LARGEST_COUNT
) -> float:
    """Return the number called `name`, within bounds; like all functions below, raise ValueError for anything else."""
    value = _entry(record, name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{name} must be a finite number, got {_shown(value)}")
    if not least <= value <= most:
        raise ValueError(f"{name} must be between {least:g} and {most:g}, got {_shown(value)}")
    return float(value)


def integer(record: JsonObject, name: str, below: int = 2**31) -> int:
    """Return the integer called `name`, at least 0 and less than `below`."""
    value = _entry(record, name)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < below:
        raise ValueError(f"{name} must be an integer from 0 to {below - 1}, got {_shown(value)}")
    return value


def integers(record: JsonObject, name: str, below: int) -> tuple[int, ...]:
    """Return the list of integers called `name`, each at least 0 and less than `below`."""
    values = as_list(_entry(record, name), name)
    return tuple(integer({name: value}, name, below) for value in values)


def string(record: JsonObject, name: str) -> str:
    """Return the string called `name`."""
    value = _entry(record, name)
    if not isinstance(value, str):
        raise ValueError(f"{name} must be a string, got {_shown(value)}")
    return value


def boolean(record: JsonObject, name: str) -> bool:
    """Return the boolean called `name`."""
    value = _entry(record, name)
    if not isinstance(value, bool):
        raise ValueError(f"{name} must be true or false, got {_shown(value)}")
    return value


def choice(record: JsonObject, name: str, known: Iterable[str]) -> str:
    """Return the string called `name`, which must be one of `known`."""
    value = string(record, name)
    if value not in known:
        raise ValueError(f"{name} must be one of {', '.join(known)}, got {_shown(value)}")
    return value


def table(record: JsonObject, name: str, width: int) -> Floats:
    """Return the numbers called `name` as ``(n, width)``; a single row may be a flat list.

    They are at most `LARGEST_COORDINATE`, because all tables of a record are coordinates or matrices.
    """
    values = np.array(as_list(_entry(record, name), name), dtype=np.float64)
    if not (values.size == 0 or values.shape[-1] == width) or not np.isfinite(values).all():
        raise ValueError(f"{name} must be rows of {width} finite numbers each")
    if np.abs(values).max(initial=0.0) > LARGEST_COORDINATE:
        raise ValueError(f"the numbers of {name} must be at most {LARGEST_COORDINATE:g}")
    return values.reshape(-1, width)


def _entry(record: JsonObject, name: str) -> Any:
    """Return the value called `name`, which must be present."""
    if name not in record:
        raise ValueError(f"{name} is missing")
    return record[name]


def _shown(value: Any) -> str:
    shown = repr(value)
    return shown if len(shown) <= 40 else shown[:37] + "..."
