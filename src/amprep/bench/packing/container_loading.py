"""Read container-loading instances: fill one container with boxes that may be rotated axis by axis."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem
from amprep.model.rotations import axis_rotations
from amprep.testing.packing_instances import PackingInstance

MAX_BOXES = 100_000
MAX_BYTES = 100_000_000

_FORMAT = (
    'expected {"instances": [{"container": {"X", "Y", "Z"}, "items": [{"X", "Y", "Z", "COPIES", '
    '"ROTATION_XYZ", ...}]}]}'
)


def read_instances(path: Path) -> list[PackingInstance]:
    """Return the instances of a JSON file as fill problems; the value of a box is its volume.

    ``ROTATION_YXZ`` = 1 allows the orientation in which the box's y side is along the container's x axis, its
    x side along y, and its z side along z.

    Raises
    ------
    InputError
        If the file cannot be read or has another format.
    """
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"{path}: larger than {MAX_BYTES} bytes; split the file")
        record = json.loads(path.read_text(encoding="utf-8"))
        rows = record.get("instances", [record])
        name = str(record.get("name", path.stem))
        return [_instance(f"{name}_{row.get('index', i)}", row) for i, row in enumerate(rows, start=1)]
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give a JSON file") from error
    except KeyError as error:
        raise InputError(f"{path}: {error.args[0]} is missing; {_FORMAT}") from error
    except (ValueError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        raise InputError(f"{path}: not a container-loading file ({error}); {_FORMAT}") from error


def _instance(name: str, row: dict[str, Any]) -> PackingInstance:
    items: list[Item] = []
    for part, entry in enumerate(row["items"]):
        size, copies = _size(entry), int(entry.get("COPIES", 1))
        if copies < 0 or len(items) + copies > MAX_BOXES:
            raise ValueError(f"box {part + 1}: COPIES must be 0 to {MAX_BOXES} in total, got {copies}")
        volume, allowed = Boxes(np.zeros((1, 3)), size[None]), _orientations(entry)
        items += [Item(part, copy, volume, float(size.prod()), allowed) for copy in range(copies)]
    return PackingInstance(name, PackingProblem(tuple(items), BuildVolume(_size(row["container"])), "fill"))


def _size(entry: dict[str, Any]) -> Floats:
    size = np.array([float(entry[axis]) for axis in "XYZ"])
    if not (np.isfinite(size).all() and (size > 0.0).all()):
        raise ValueError(f"X, Y and Z must be positive lengths, got {size.tolist()}")
    return size


def _orientations(entry: dict[str, Any]) -> Orientations:
    """Return the orientations that the flags allow, one per set of sides; without flags only the given one."""
    allowed = [matrix for matrix in axis_rotations() if int(entry.get(_flag(matrix), 0))]
    patterns = {np.abs(matrix).tobytes(): matrix for matrix in reversed(allowed)}
    return Orientations("list", np.array(list(patterns.values())[::-1])) if patterns else Orientations()


def _flag(matrix: Floats) -> str:
    """Return the name of the flag: the sides of the box along x, y and z."""
    return "ROTATION_" + "".join("XYZ"[int(np.argmax(row))] for row in np.abs(matrix))
