"""Reads container-loading instances: boxes that may be turned axis by axis, to fill one container."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.bench.packing.instances import Instance
from amprep.errors import InputError
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem
from amprep.model.rotations import axis_rotations

MOST_BOXES = 100_000
MOST_BYTES = 100_000_000

_EXPECTED = (
    'expected {"instances": [{"container": {"X", "Y", "Z"}, "items": [{"X", "Y", "Z", "COPIES", '
    '"ROTATION_XYZ", ...}]}]}'
)


def read_loading(path: Path) -> list[Instance]:
    """Return the instances of a JSON file as fill problems; a box is worth its volume.

    ``ROTATION_YXZ`` = 1 allows that the box's y lies along the container's x, its x along y, its z along z.

    Raises
    ------
    InputError
        If the file cannot be read or is not of this form.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError(f"{path}: more than {MOST_BYTES} bytes; split the file")
        record = json.loads(path.read_text(encoding="utf-8"))
        rows = record.get("instances", [record])
        name = str(record.get("name", path.stem))
        return [_instance(f"{name}_{row.get('index', i)}", row) for i, row in enumerate(rows, start=1)]
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give a JSON file") from error
    except KeyError as error:
        raise InputError(f"{path}: {error.args[0]} is missing; {_EXPECTED}") from error
    except (ValueError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        raise InputError(f"{path}: not a container-loading file ({error}); {_EXPECTED}") from error


def _instance(name: str, row: dict[str, Any]) -> Instance:
    items: list[Item] = []
    for part, entry in enumerate(row["items"]):
        size, copies = _size(entry), int(entry.get("COPIES", 1))
        if copies < 0 or len(items) + copies > MOST_BOXES:
            raise ValueError(f"box {part + 1}: its copies must be 0 to {MOST_BOXES} in all, got {copies}")
        volume, allowed = Boxes(np.zeros((1, 3)), size[None]), _orientations(entry)
        items += [Item(part, copy, volume, float(size.prod()), allowed) for copy in range(copies)]
    return Instance(name, PackingProblem(tuple(items), BuildVolume(_size(row["container"])), "fill"))


def _size(entry: dict[str, Any]) -> Floats:
    size = np.array([float(entry[axis]) for axis in "XYZ"])
    if not (np.isfinite(size).all() and (size > 0.0).all()):
        raise ValueError(f"X, Y and Z must be positive lengths, got {size.tolist()}")
    return size


def _orientations(entry: dict[str, Any]) -> Orientations:
    """Return the rotations that the flags allow; without any flag the box stands as it is."""
    allowed = [matrix for matrix in axis_rotations() if int(entry.get(_flag(matrix), 0))]
    patterns = {np.abs(matrix).tobytes(): matrix for matrix in reversed(allowed)}
    return Orientations("list", np.array(list(patterns.values())[::-1])) if patterns else Orientations()


def _flag(matrix: Floats) -> str:
    """Return the name of the flag: which side of the box lies along x, y and z."""
    return "ROTATION_" + "".join("XYZ"[int(np.argmax(row))] for row in np.abs(matrix))
