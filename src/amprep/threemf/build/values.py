"""JSON text, and checked access to the values in it: a record from a file may hold anything."""

import json
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from amprep.arrays import Floats

Record = Mapping[str, Any]

_TO_ESCAPE = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]|[&<>]")
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def xml_text(text: str) -> str:
    """Return the text with every character that XML forbids replaced by U+FFFD."""
    return _NOT_XML.sub("\ufffd", text)


def to_json(value: Any) -> str:
    """Return JSON that XML can carry without escapes; a list of records gets a line for each."""
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(to_json(entry) for entry in value) + "\n]"
    text = json.dumps(value, ensure_ascii=False, allow_nan=False)
    return _TO_ESCAPE.sub(lambda found: f"\\u{ord(found.group()):04x}", text)


def from_json(text: str) -> Any:
    """Return the value of JSON text.

    Raises
    ------
    ValueError
        If the text is not JSON or nests too deeply.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("its JSON nests too deeply") from None


def plain(array: Floats, decimals: int | None = None) -> Any:
    """Return an array as nested lists, whole numbers without a decimal point, so that records stay short."""
    if array.ndim > 1:
        return [plain(row, decimals) for row in array]
    values = array if decimals is None else np.round(array, decimals)
    return [int(value) if value.is_integer() and abs(value) < 2**53 else value for value in values.tolist()]


def mapping(value: Any, name: str) -> Record:
    """Return the value if it is a JSON object."""
    if not isinstance(value, dict):
        raise ValueError(f"{name} must be an object, not {_shown(value)}")
    return value


def listing(value: Any, name: str) -> list[Any]:
    """Return the value if it is a JSON list."""
    if not isinstance(value, list):
        raise ValueError(f"{name} must be a list, not {_shown(value)}")
    return value


def number(record: Record, name: str) -> float:
    """Return the finite number called `name`."""
    value = _entry(record, name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{name} must be a finite number, not {_shown(value)}")
    return float(value)


def whole(record: Record, name: str, below: int = 2**31) -> int:
    """Return the whole number called `name`, from 0 to below the limit."""
    value = _entry(record, name)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < below:
        raise ValueError(f"{name} must be a whole number from 0 to {below - 1}, not {_shown(value)}")
    return value


def wholes(record: Record, name: str, below: int) -> tuple[int, ...]:
    """Return the list of whole numbers called `name`, each from 0 to below the limit."""
    values = listing(_entry(record, name), name)
    return tuple(whole({name: value}, name, below) for value in values)


def text(record: Record, name: str) -> str:
    """Return the text called `name`."""
    value = _entry(record, name)
    if not isinstance(value, str):
        raise ValueError(f"{name} must be a text, not {_shown(value)}")
    return value


def flag(record: Record, name: str) -> bool:
    """Return the true or false called `name`."""
    value = _entry(record, name)
    if not isinstance(value, bool):
        raise ValueError(f"{name} must be true or false, not {_shown(value)}")
    return value


def word(record: Record, name: str, known: Iterable[str]) -> str:
    """Return the text called `name`, one of the known words."""
    value = text(record, name)
    if value not in known:
        raise ValueError(f"{name} must be one of {', '.join(known)}, not {_shown(value)}")
    return value


def table(record: Record, name: str, width: int) -> Floats:
    """Return the rows of finite numbers called `name`, ``(n, width)``; a single row needs no nesting."""
    values = np.array(listing(_entry(record, name), name), dtype=np.float64)
    if not (values.size == 0 or values.shape[-1] == width) or not np.isfinite(values).all():
        raise ValueError(f"{name} must be rows of {width} finite numbers")
    return values.reshape(-1, width)


def _entry(record: Record, name: str) -> Any:
    if name not in record:
        raise ValueError(f"{name} is missing")
    return record[name]


def _shown(value: Any) -> str:
    shown = repr(value)
    return shown if len(shown) <= 40 else shown[:37] + "..."
