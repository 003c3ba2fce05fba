"""Convert values to JSON and write JSON files, for all reports."""

import json
import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from amprep.checks.violation import Violation
from amprep.files import replacing
from amprep.geometry.powder.pockets import Pocket
from amprep.report.record import StageTime

_NUMBERS = re.compile(r"\[\n[-+.\deE,\s]+\n\s*\]")
"""A list of numbers over several lines. Strings in JSON contain no raw line ends, so none can match."""


def json_text(value: Any) -> str:
    """Return plain values as JSON text, with each list of numbers on one line."""
    text = json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)
    return _NUMBERS.sub(lambda found: " ".join(found[0].split()), text) + "\n"


def write_json_file(value: Any, path: Path) -> None:
    """Write plain values as JSON; the file appears complete, or not at all."""
    with replacing(path) as temporary:
        temporary.write_bytes(json_text(value).encode("utf-8", "backslashreplace"))


def plain(value: Any) -> Any:
    """Return numpy values, mappings and tuples as plain ones; a number that is not finite becomes None."""
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, (set, frozenset)):
        return sorted(map(str, value))
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, float):
        return value + 0.0 if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)


def violations_json(violations: Iterable[Violation]) -> list[dict[str, Any]]:
    """Return broken promises."""
    return [vars(found) for found in violations]


def stages_json(stages: Iterable[StageTime]) -> list[dict[str, Any]]:
    """Return the durations of stages."""
    return [{"name": stage.name, "seconds": round(stage.seconds, 3)} for stage in stages]


def pockets_json(pockets: Iterable[Pocket]) -> list[dict[str, Any]]:
    """Return pockets of trapped powder."""
    return [
        {
            "volume_mm3": pocket.volume,
            "position_mm": pocket.point,
            "low_mm": pocket.lo,
            "high_mm": pocket.hi,
            "closed": pocket.closed,
        }
        for pocket in pockets
    ]
