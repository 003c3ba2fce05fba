"""Read the log of a build: how long each layer took, and what area was scanned in it."""

import csv
import math
from pathlib import Path

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError, nearest_hint

LARGEST = 64 << 20
"""Largest size of a log, bytes."""

MOST_LAYERS = 1_000_000
COLUMNS = ("layer", "seconds", "area")


def read_layer_log(path: Path) -> tuple[Floats, Floats]:
    """Return the seconds ``(n,)`` and the area ``(n,)`` mm2 of the layers in a CSV file, in its order.

    Raises
    ------
    InputError
        If the file cannot be read, is too large, lacks a column, or has a row that is no layer; the message names the
        row as a spreadsheet counts it.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise InputError(f"{path}: larger than {LARGEST >> 20} MiB, which no log of a build is")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not text in UTF-8; save it as CSV in UTF-8") from error
    try:
        return _layers(text, path)
    except csv.Error as error:
        raise InputError(f"{path}: not CSV: {error}") from error


def _layers(text: str, path: Path) -> tuple[Floats, Floats]:
    lines = text.splitlines()
    separator = ";" if lines and lines[0].count(";") > lines[0].count(",") else ","
    reader = csv.reader(lines, delimiter=separator)
    names = [name.strip().lower() for name in next(reader, [])]
    for column in COLUMNS:
        if names.count(column) != 1:
            hint = nearest_hint(column, [name for name in names if name]) if column not in names else ""
            raise InputError(f"{path}: expected one column {column!r} in its first row{hint}")
    places = [names.index(column) for column in COLUMNS]
    rows = [_row(row, places, f"{path}: row {reader.line_num}") for row in reader if any(map(str.strip, row))]
    if len(rows) > MOST_LAYERS:
        raise InputError(f"{path}: more than {MOST_LAYERS} layers")
    values = np.array(rows, np.float64).reshape(-1, len(COLUMNS))
    return values[:, 1], values[:, 2]


def _row(row: list[str], places: list[int], where: str) -> list[float]:
    try:
        values = [float(row[place]) for place in places]
    except (ValueError, IndexError):
        values = [math.nan]
    if not all(math.isfinite(value) and 0.0 <= value <= 1e12 for value in values):
        raise InputError(f"{where}: expected numbers of at least 0 for {', '.join(COLUMNS)}")
    return values
